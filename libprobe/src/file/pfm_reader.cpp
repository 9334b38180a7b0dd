#include "file/image_formats.h"

#include <wavelet/base/error.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace haarlight::probe {
namespace {

struct PfmHeader {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t channels = 0;
  double scale = 0;
  std::size_t data_offset = 0;
};

class PfmHeaderParser {
public:
  PfmHeaderParser(std::span<const std::byte> bytes, const std::string& path)
      : m_text(reinterpret_cast<const char*>(bytes.data()), bytes.size()), m_path(path) {}

  PfmHeader parse() {
    const std::string_view type = next_word();
    m_header.channels = type == "Pf" ? 1 : type == "PF4" ? 4 : 3;
    const bool crlf = m_text.substr(m_position).starts_with("\r\n");
    m_header.width = extent("width");
    m_header.height = extent("height");
    read_scale();
    ++m_position; // the white space after the scale
    if (crlf && m_text[m_position - 1] == '\r' && m_text.substr(m_position).starts_with("\n"))
      ++m_position;
    m_header.data_offset = m_position;
    return m_header;
  }

private:
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  [[noreturn]] void fail(const std::string& message) const {
    throw_input_error(m_path, message, m_word_offset);
  }

  /// The next word, which must be followed by white space.
  std::string_view next_word() {
    constexpr std::size_t longest = 64;
    while (m_position < m_text.size() && is_space(m_text[m_position]))
      ++m_position;
    m_word_offset = m_position;
    while (m_position < m_text.size() && !is_space(m_text[m_position]) &&
           m_position - m_word_offset < longest)
      ++m_position;
    if (m_position >= m_text.size() || !is_space(m_text[m_position]))
      fail("the PFM header must read like 'PF', width, height, scale and a line end");
    return m_text.substr(m_word_offset, m_position - m_word_offset);
  }

  std::uint64_t extent(const char* name) {
    const std::string_view word = next_word();
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || value < 1 || value > max_pixels)
      fail(std::string("the ") + name + " must be a number from 1 to " +
           std::to_string(max_pixels));
    return value;
  }

  void read_scale() {
    std::string_view word = next_word();
    if (word.starts_with('+'))
      word.remove_prefix(1);
    const auto [end, error] =
        std::from_chars(word.data(), word.data() + word.size(), m_header.scale);
    if (error != std::errc{} || end != word.data() + word.size() ||
        !std::isfinite(m_header.scale) || m_header.scale == 0)
      fail("the scale must be a number other than 0, negative for little-endian values");
  }

  std::string_view m_text;
  const std::string& m_path;
  std::size_t m_position = 0;
  std::size_t m_word_offset = 0;
  PfmHeader m_header;
};

void check_size(const PfmHeader& header, std::size_t file_size, const std::string& path) {
  const std::uint64_t pixels = header.width * header.height;
  if (pixels > max_pixels)
    throw_input_error(path, "has " + std::to_string(pixels) + " pixels, at most " +
                                std::to_string(max_pixels) + " are read");
  const std::uint64_t expected = pixels * header.channels * sizeof(float);
  const std::uint64_t found = file_size - header.data_offset;
  if (found != expected)
    throw_input_error(path,
                      std::to_string(found) + " bytes follow the header, " +
                          std::to_string(header.width) + " x " + std::to_string(header.height) +
                          " pixels take " + std::to_string(expected),
                      header.data_offset);
}

float decode(const std::byte* bytes, bool swap) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, bytes, sizeof bits);
  return std::bit_cast<float>(swap ? __builtin_bswap32(bits) : bits);
}

} // namespace

Image read_pfm(std::span<const std::byte> bytes, const std::string& path,
               std::vector<std::string>& notes) {
  const PfmHeader header = PfmHeaderParser(bytes, path).parse();
  check_size(header, bytes.size(), path);
  const bool swap = (header.scale < 0) != (std::endian::native == std::endian::little);
  const double scale = std::abs(header.scale); // may exceed the range of float where values do not
  Image image(static_cast<int>(header.width), static_cast<int>(header.height));
  const std::byte* from = bytes.data() + header.data_offset;
  for (int y = image.height - 1; y >= 0; --y)
    for (int x = 0; x < image.width; ++x, from += header.channels * sizeof(float)) {
      float* to = image.rgb.data() + image.offset(x, y);
      for (std::size_t c = 0; c < 3; ++c)
        to[c] = static_cast<float>(
            scale * static_cast<double>(
                        decode(from + (header.channels == 1 ? 0 : c * sizeof(float)), swap)));
    }
  if (scale != 1)
    notes.emplace_back("values were multiplied by the scale of the PFM header");
  if (header.channels == 4)
    notes.emplace_back("the fourth channel was dropped");
  return image;
}

} // namespace haarlight::probe
