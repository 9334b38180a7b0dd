#include <probe/rgbe.h>

#include "file/colour_space.h"
#include "file/image_formats.h"

#include <wavelet/base/error.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace haarlight::probe {
namespace {

/// The variables and the size line of a header. Scanlines run along the second axis of the size
/// line.
struct RgbeHeader {
  std::uint64_t lines = 0;                  ///< extent of the first axis
  std::uint64_t length = 0;                 ///< extent of the second axis, pixels of a scanline
  bool lines_are_rows = true;               ///< the first axis is Y
  bool x_reversed = false;                  ///< −X: a scanline, or the scanlines, run to the left
  bool y_reversed = false;                  ///< +Y: they run upwards
  std::optional<Eigen::Matrix3d> to_rec709; ///< of XYZ or foreign primaries; none for Rec. 709
  std::array<double, 3> exposure = {1, 1, 1}; ///< the factors that the pixels were multiplied by
  std::uint64_t size_offset = 0;
  std::uint64_t data_offset = 0;

  int width() const { return static_cast<int>(lines_are_rows ? length : lines); }
  int height() const { return static_cast<int>(lines_are_rows ? lines : length); }

  /// Column and row, from the top left, of pixel i of scanline s.
  std::pair<int, int> place(std::uint64_t s, std::uint64_t i) const {
    const int along_x = static_cast<int>(lines_are_rows ? i : s);
    const int along_y = static_cast<int>(lines_are_rows ? s : i);
    return {x_reversed ? width() - 1 - along_x : along_x,
            y_reversed ? height() - 1 - along_y : along_y};
  }
};

/// CIE chromaticities x, y of red, green, blue and white, as in a PRIMARIES line.
using Primaries = std::array<double, 8>;

/// True for primaries that are read as Rec. 709: those of Rec. 709 themselves, Radiance's default,
/// and eight zeros, which Photoshop writes. Headers round to three digits.
bool are_rec709(const Primaries& primaries) {
  constexpr Primaries rec709 = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
  constexpr Primaries radiance_default = {0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.333, 0.333};
  const auto is_near = [&](const Primaries& known) {
    return std::equal(primaries.begin(), primaries.end(), known.begin(),
                      [](double u, double v) { return std::abs(u - v) < 0.002; });
  };
  return is_near(rec709) || is_near(radiance_default) || primaries == Primaries{};
}

std::optional<Eigen::Matrix3d> primaries_to_rec709(const Primaries& p) {
  return rec709_from_rgb({{p[0], p[1]}, {p[2], p[3]}, {p[4], p[5]}, {p[6], p[7]}});
}

/// Longest header read in bytes: comments of thousands of lines occur, megabytes of them do not.
constexpr std::size_t longest_header = std::size_t{1} << 20;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos)
    return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Takes the first word off a text; empty if there is none.
std::string_view take_word(std::string_view& text) {
  text = trimmed(text);
  const std::string_view word = text.substr(0, text.find_first_of(" \t"));
  text.remove_prefix(word.size());
  return word;
}

template <class T>
std::optional<T> parse_number(std::string_view word) {
  if (!word.empty() && word.front() == '+')
    word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || word.empty())
    return std::nullopt;
  return value;
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), longest_header)};
}

/// The line from `position` on, without its end (LF or CR LF); moves `position` behind it.
std::optional<std::string_view> next_line(std::string_view text, std::size_t& position) {
  const auto end = text.find('\n', position);
  if (end == std::string_view::npos)
    return std::nullopt;
  std::string_view line = text.substr(position, end - position);
  if (line.ends_with('\r'))
    line.remove_suffix(1);
  position = end + 1;
  return line;
}

/// The value of a variable that begins in the first column; programs that compose pictures indent
/// the headers of their inputs, which must not count.
std::optional<std::string_view> value_of(std::string_view line, std::string_view name) {
  if (!line.starts_with(name) || line.substr(name.size(), 1) != "=")
    return std::nullopt;
  return line.substr(name.size() + 1);
}

/// Exactly `count` numbers separated by blanks.
template <std::size_t count>
std::optional<std::array<double, count>> parse_numbers(std::string_view text) {
  std::array<double, count> numbers{};
  for (double& number : numbers) {
    const auto parsed = parse_number<double>(take_word(text));
    if (!parsed || !std::isfinite(*parsed))
      return std::nullopt;
    number = *parsed;
  }
  return trimmed(text).empty() ? std::optional(numbers) : std::nullopt;
}

/// One axis of the size line, as `-Y 256`.
struct Axis {
  char letter = 0;
  bool minus = false;
  std::uint64_t extent = 0;
};

std::optional<Axis> take_axis(std::string_view& line) {
  const std::string_view name = take_word(line);
  const auto extent = parse_number<std::uint64_t>(take_word(line));
  const bool named = name == "-X" || name == "+X" || name == "-Y" || name == "+Y";
  if (!named || !extent || *extent < 1 || *extent > 0x7fffffff)
    return std::nullopt;
  return Axis{name[1], name[0] == '-', *extent};
}

/// Both axes of the size line in their order.
std::optional<std::array<Axis, 2>> parse_size_line(std::string_view line) {
  const auto first = take_axis(line);
  const auto second = take_axis(line);
  if (!first || !second || first->letter == second->letter || !trimmed(line).empty())
    return std::nullopt;
  return std::array{*first, *second};
}

class RgbeHeaderParser {
public:
  RgbeHeaderParser(std::span<const std::byte> bytes, const std::string& path)
      : m_text(text_of(bytes)), m_path(path) {}

  RgbeHeader parse() {
    for (auto line = read_line(); !line.empty(); line = read_line())
      read_variable(line);
    const auto size_line = read_line();
    m_header.size_offset = m_line_offset;
    read_size(size_line);
    m_header.data_offset = m_position;
    m_header.to_rec709 = m_xyz ? std::optional(rec709_from_xyz()) : m_primaries_to_rec709;
    return m_header;
  }

private:
  [[noreturn]] void fail(const std::string& fault) const {
    throw_input_error(m_path, fault, m_line_offset);
  }

  std::string_view read_line() {
    m_line_offset = m_position;
    const auto line = next_line(m_text, m_position);
    if (!line)
      fail("the header does not end: a blank line and the size, as -Y 256 +X 256, are missing");
    if (line->find('\0') != std::string_view::npos)
      fail("the header line holds a NUL byte, text is needed");
    return *line;
  }

  void read_variable(std::string_view line) {
    if (const auto format = value_of(line, "FORMAT"))
      read_format(trimmed(*format));
    else if (const auto exposure = value_of(line, "EXPOSURE"))
      multiply_exposure(parse_numbers<1>(*exposure));
    else if (const auto correction = value_of(line, "COLORCORR"))
      multiply_exposure(parse_numbers<3>(*correction));
    else if (const auto primaries = value_of(line, "PRIMARIES"))
      read_primaries(*primaries);
    else if (const auto gamma = value_of(line, "GAMMA"))
      check_gamma(*gamma);
  }

  void read_format(std::string_view format) {
    m_xyz = format == "32-bit_rle_xyze";
    if (!m_xyz && format != "32-bit_rle_rgbe")
      fail("FORMAT is '" + std::string(format) + "', 32-bit_rle_rgbe or 32-bit_rle_xyze is read");
  }

  template <std::size_t count>
  void multiply_exposure(const std::optional<std::array<double, count>>& factors) {
    if (!factors)
      fail("EXPOSURE needs one number, COLORCORR three");
    for (std::size_t c = 0; c < 3; ++c) {
      m_header.exposure[c] *= (*factors)[count == 1 ? 0 : c];
      // RGBE values span 2^±128; an exposure beyond that leaves none of them.
      if (!(m_header.exposure[c] > 0x1p-256 && m_header.exposure[c] < 0x1p256))
        fail("EXPOSURE and COLORCORR must multiply up to positive numbers of at most 2^256");
    }
  }

  void read_primaries(std::string_view value) {
    const auto primaries = parse_numbers<8>(value);
    if (!primaries)
      fail("PRIMARIES needs eight numbers: x and y of red, green, blue and white");
    m_primaries_to_rec709.reset();
    if (are_rec709(*primaries))
      return;
    m_primaries_to_rec709 = primaries_to_rec709(*primaries);
    if (!m_primaries_to_rec709)
      fail("PRIMARIES do not span a colour space");
  }

  /// 0 is written by programs that leave it unset.
  void check_gamma(std::string_view value) const {
    const auto gamma = parse_numbers<1>(value);
    if (!gamma || ((*gamma)[0] != 0 && (*gamma)[0] != 1))
      fail("GAMMA is '" + std::string(trimmed(value)) + "', linear pixels (1) are read");
  }

  void read_size(std::string_view line) {
    const auto axes = parse_size_line(line);
    if (!axes)
      fail("the size line must name X and Y once each with their extents, like -Y 256 +X 256");
    const auto& [first, second] = *axes;
    m_header.lines = first.extent;
    m_header.length = second.extent;
    m_header.lines_are_rows = first.letter == 'Y';
    m_header.x_reversed = (m_header.lines_are_rows ? second : first).minus;
    m_header.y_reversed = !(m_header.lines_are_rows ? first : second).minus;
  }

  std::string_view m_text;
  const std::string& m_path;
  std::size_t m_position = 0;
  std::size_t m_line_offset = 0;
  bool m_xyz = false;
  std::optional<Eigen::Matrix3d> m_primaries_to_rec709;
  RgbeHeader m_header;
};

} // namespace

bool is_rgbe(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  if (text.starts_with("#?"))
    return true;
  std::size_t position = 0;
  for (auto line = next_line(text, position); line; line = next_line(text, position)) {
    if (line->find('\0') != std::string_view::npos)
      return false;
    if (line->empty()) {
      const auto size_line = next_line(text, position);
      return size_line && parse_size_line(*size_line);
    }
    if (const auto format = value_of(*line, "FORMAT"))
      return trimmed(*format).starts_with("32-bit_rle_");
  }
  return false;
}

namespace {

/// @throws Error(Input) with the byte offset of the offending line
RgbeHeader read_rgbe_header(std::span<const std::byte> bytes, const std::string& path) {
  if (!is_rgbe(bytes))
    throw_input_error(path,
                      "is no Radiance picture: neither #?RADIANCE, nor FORMAT=32-bit_rle_rgbe, nor "
                      "a blank line and a size line are found",
                      0);
  return RgbeHeaderParser(bytes, path).parse();
}

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

  [[noreturn]] void fail(const std::string& fault, std::size_t offset) const {
    throw_input_error(m_path, "scanline " + std::to_string(m_line) + " " + fault, offset);
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
class RgbeDecoder {
public:
  explicit RgbeDecoder(const RgbeHeader& header) : m_to_rec709(header.to_rec709) {
    for (int e = 1; e < 256; ++e)
      m_power[static_cast<std::size_t>(e)] = std::ldexp(1.0, e - 136);
    for (std::size_t c = 0; c < 3; ++c)
      m_scale[c] = 1.0 / header.exposure[c];
  }

  Rgb operator()(const Pixel& p) const {
    const double unit = m_power[p[3]];
    const Eigen::Array3d v(p[0] * unit * m_scale[0], p[1] * unit * m_scale[1],
                           p[2] * unit * m_scale[2]);
    return (m_to_rec709 ? convert_colour(*m_to_rec709, v) : v).cast<float>();
  }

private:
  std::array<double, 256> m_power{};
  std::array<double, 3> m_scale{};
  std::optional<Eigen::Matrix3d> m_to_rec709;
};

/// Refuses a picture too large, and one whose scanlines are malformed or do not hold all of its
/// pixels. Reads the encoded bytes once and allocates nothing: a chain of old run lengths may
/// represent 2^32 pixels in 20 bytes, so no bound by the size of the file alone is tight.
void check_rgbe_size(std::span<const std::byte> bytes, const RgbeHeader& header,
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

Image read_rgbe(std::span<const std::byte> bytes, const std::string& path) {
  const RgbeHeader header = read_rgbe_header(bytes, path);
  check_rgbe_size(bytes, header, path);
  const RgbeDecoder decode(header);
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
