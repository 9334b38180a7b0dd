#include <probe/rgbe.h>

#include "file/rgbe_header.h"

#include <wavelet/base/error.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

namespace haarlight::probe {
namespace {

using Pixel = std::array<std::uint8_t, 4>;

/// Decodes the scanlines of a picture, never past the end of its bytes. Without a buffer it only
/// checks them, so that a malformed file is refused before its pixels are allocated.
class ScanlineReader {
public:
  ScanlineReader(std::span<const std::byte> bytes, const std::string& path,
                 const RgbeHeader& header)
      : m_bytes(bytes), m_path(path), m_position(header.data_offset), m_length(header.length) {}

  void check_next() { read(nullptr); }

  /// @param line receives the pixels of the scanline
  void read_next(std::vector<Pixel>& line) {
    line.resize(m_length);
    read(line.data());
  }

private:
  /// Reads the next scanline, of either coding.
  void read(Pixel* line) {
    const bool may_be_new = m_length >= 8 && m_length <= 32767;
    if (may_be_new && m_bytes.size() - m_position >= 4 && peek(0) == 2 && peek(1) == 2 &&
        peek(2) < 128)
      read_components(line);
    else
      read_pixels(line);
    ++m_line;
  }

  std::uint8_t peek(std::size_t ahead) const {
    return std::to_integer<std::uint8_t>(m_bytes[m_position + ahead]);
  }

  [[noreturn]] void fail(const std::string& what, std::size_t offset) const {
    throw_input_error(m_path, "scanline " + std::to_string(m_line) + " " + what, offset);
  }

  void need(std::size_t count) const {
    if (m_bytes.size() - m_position < count)
      fail("is cut short: the file ends here", m_bytes.size());
  }

  std::uint8_t next() {
    need(1);
    return std::to_integer<std::uint8_t>(m_bytes[m_position++]);
  }

  Pixel next_pixel() {
    need(4);
    Pixel pixel;
    std::memcpy(pixel.data(), m_bytes.data() + m_position, 4);
    m_position += 4;
    return pixel;
  }

  /// New run lengths: the line's four components one after the other.
  void read_components(Pixel* line) {
    const std::size_t length = std::size_t{peek(2)} << 8U | peek(3);
    if (length != m_length)
      fail("says it holds " + std::to_string(length) + " pixels, the picture's have " +
               std::to_string(m_length),
           m_position);
    m_position += 4;
    for (std::size_t component = 0; component < 4; ++component)
      read_component(line, component);
  }

  void read_component(Pixel* line, std::size_t component) {
    for (std::size_t x = 0; x < m_length;) {
      const std::size_t start = m_position;
      const unsigned code = next();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128 : code;
      if (count == 0 || count > m_length - x)
        fail("has a run of " + std::to_string(count) + " where 1 to " +
                 std::to_string(m_length - x) + " pixels are left",
             start);
      need(run ? 1 : count);
      for (std::size_t i = 0; line != nullptr && i < count; ++i)
        line[x + i][component] = peek(run ? 0 : i);
      m_position += run ? 1 : count;
      x += count;
    }
  }

  /// Flat pixels, among which (1, 1, 1, n) repeats the one before n times (old run lengths);
  /// repeats in a row are the bytes of one count, the least first.
  void read_pixels(Pixel* line) {
    unsigned shift = 0;
    for (std::uint64_t x = 0; x < m_length;) {
      const std::size_t start = m_position;
      const Pixel pixel = next_pixel();
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
        if (line != nullptr)
          line[x] = pixel;
        ++x;
        shift = 0;
        continue;
      }
      const std::uint64_t count = shift < 32 ? std::uint64_t{pixel[3]} << shift : 0;
      if (x == 0 || shift >= 32 || count > m_length - x)
        fail("has a repeat that does not fit", start);
      if (line != nullptr)
        std::fill_n(line + x, count, line[x - 1]);
      x += count;
      shift += 8;
    }
  }

  std::span<const std::byte> m_bytes;
  const std::string& m_path;
  std::size_t m_position;
  std::uint64_t m_length;
  std::uint64_t m_line = 0;
};

/// Converts mantissas and exponents to linear Rec. 709 RGB, the exposure undone.
class Decoder {
public:
  explicit Decoder(const RgbeHeader& header) : m_to_rec709(header.to_rec709) {
    for (int e = 1; e < 256; ++e)
      m_power[static_cast<std::size_t>(e)] = std::ldexp(1.0, e - 136);
    for (std::size_t c = 0; c < 3; ++c)
      m_scale[c] = 1.0 / header.exposure[c];
  }

  Rgb operator()(const Pixel& p) const {
    const double unit = m_power[p[3]];
    const Eigen::Array3d v(p[0] * unit * m_scale[0], p[1] * unit * m_scale[1],
                           p[2] * unit * m_scale[2]);
    return (m_to_rec709 ? multiply(*m_to_rec709, v) : v).cast<float>();
  }

private:
  static Eigen::Array3d multiply(const ColourMatrix& m, const Eigen::Array3d& v) {
    const auto row = [&](std::size_t r) {
      return m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2];
    };
    return {row(0), row(1), row(2)};
  }

  std::array<double, 256> m_power{};
  std::array<double, 3> m_scale{};
  std::optional<ColourMatrix> m_to_rec709;
};

/// Refuses a picture too large, and one whose scanlines are malformed or do not hold all of its
/// pixels. Reads the encoded bytes once and allocates nothing: a chain of old run lengths may
/// stand for 2^32 pixels in 20 bytes, so no bound by the size of the file alone would be tight.
void check_picture(std::span<const std::byte> bytes, const RgbeHeader& header,
                   const std::string& path) {
  const std::uint64_t pixels = header.lines * header.length;
  if (pixels > max_pixels)
    throw_input_error(path,
                      "is said to have " + std::to_string(pixels) + " pixels, at most " +
                          std::to_string(max_pixels) + " are read",
                      header.size_offset);
  ScanlineReader reader(bytes, path, header);
  for (std::uint64_t s = 0; s < header.lines; ++s)
    reader.check_next();
}

} // namespace

Rgb decode_rgbe(const std::array<std::uint8_t, 4>& pixel) {
  static const Decoder decoder{RgbeHeader{}};
  return decoder(pixel);
}

Image read_rgbe(std::span<const std::byte> bytes, const std::string& path) {
  const RgbeHeader header = read_rgbe_header(bytes, path);
  check_picture(bytes, header, path);
  const Decoder decode(header);
  Image image(header.width(), header.height());
  ScanlineReader reader(bytes, path, header);
  std::vector<Pixel> line;
  for (std::uint64_t s = 0; s < header.lines; ++s) {
    reader.read_next(line);
    for (std::uint64_t i = 0; i < header.length; ++i) {
      const auto [x, y] = header.place(s, i);
      image.set(x, y, decode(line[i]));
    }
  }
  return image;
}

} // namespace haarlight::probe
