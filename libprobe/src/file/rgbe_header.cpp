#include "file/rgbe_header.h"

#include <probe/rgbe.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace haarlight::probe {
namespace {

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

class HeaderParser {
public:
  HeaderParser(std::span<const std::byte> bytes, const std::string& path)
      : m_text(text_of(bytes)), m_path(path) {}

  RgbeHeader parse() {
    for (auto line = read_line(); !line.empty(); line = read_line())
      read_variable(line);
    const auto size_line = read_line();
    m_header.size_offset = m_line_offset;
    read_size(size_line);
    m_header.data_offset = m_position;
    m_header.to_rec709 = m_xyz ? std::optional(xyz_to_rec709) : m_primaries_to_rec709;
    return m_header;
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw_input_error(m_path, what, m_line_offset);
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
  std::optional<ColourMatrix> m_primaries_to_rec709;
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

RgbeHeader read_rgbe_header(std::span<const std::byte> bytes, const std::string& path) {
  if (!is_rgbe(bytes))
    throw_input_error(path,
                      "is no Radiance picture: neither #?RADIANCE, nor FORMAT=32-bit_rle_rgbe, nor "
                      "a blank line and a size line are found",
                      0);
  return HeaderParser(bytes, path).parse();
}

} // namespace haarlight::probe
