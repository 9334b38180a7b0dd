#include "rgbe_header.h"

#include <probe/rgbe.h>

#include <wavelet/error.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace haarlight::probe {
namespace {

/// Longest header read: comments of thousands of lines occur, megabytes of them do not.
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

class HeaderParser {
public:
  HeaderParser(std::span<const std::byte> bytes, const std::string& path)
      : m_text(reinterpret_cast<const char*>(bytes.data()), std::min(bytes.size(), longest_header)),
        m_path(path) {}

  RgbeHeader parse() {
    next_line();
    for (auto line = next_line(); !line.empty(); line = next_line())
      read_variable(line);
    const auto size_line = next_line();
    m_header.size_offset = m_line_offset;
    read_size(size_line);
    m_header.data_offset = m_position;
    return m_header;
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw_input_error(m_path, what, m_line_offset);
  }

  std::string_view next_line() {
    m_line_offset = m_position;
    const auto end = m_text.find('\n', m_position);
    if (end == std::string_view::npos)
      fail("the header does not end: a blank line and the size, as -Y 256 +X 256, are missing");
    m_position = end + 1;
    return trimmed(m_text.substr(m_line_offset, end - m_line_offset));
  }

  void read_variable(std::string_view line) {
    const auto equals = line.find('=');
    if (line.front() == '#' || equals == std::string_view::npos)
      return;
    const std::string_view name = trimmed(line.substr(0, equals));
    const std::string_view value = line.substr(equals + 1);
    if (name == "FORMAT")
      read_format(trimmed(value));
    else if (name == "EXPOSURE")
      multiply_exposure(value, false);
    else if (name == "COLORCORR")
      multiply_exposure(value, true);
  }

  void read_format(std::string_view format) {
    m_header.xyz = format == "32-bit_rle_xyze";
    if (!m_header.xyz && format != "32-bit_rle_rgbe")
      fail("FORMAT is '" + std::string(format) + "', 32-bit_rle_rgbe or 32-bit_rle_xyze is read");
  }

  void multiply_exposure(std::string_view value, bool each_its_own) {
    std::optional<double> factor;
    for (double& exposure : m_header.exposure) {
      if (!factor || each_its_own)
        factor = parse_number<double>(take_word(value));
      if (!factor || !std::isfinite(*factor) || *factor <= 0)
        fail("EXPOSURE and COLORCORR must be positive numbers");
      exposure *= *factor;
    }
    if (!trimmed(value).empty())
      fail("EXPOSURE has one number, COLORCORR three");
  }

  /// One axis of the size line: sign and letter, and the extent.
  std::uint64_t read_axis(std::string_view name, std::string_view extent) {
    const bool minus = name.size() == 2 && name[0] == '-';
    const bool plus = name.size() == 2 && name[0] == '+';
    const auto count = parse_number<std::uint64_t>(extent);
    if ((!minus && !plus) || (name[1] != 'X' && name[1] != 'Y') || !count || *count < 1 ||
        *count > 0x7fffffff)
      fail("the size line must read like -Y 256 +X 256");
    if (name[1] == 'X')
      m_header.x_reversed = minus;
    else
      m_header.y_reversed = plus;
    return *count;
  }

  void read_size(std::string_view line) {
    const std::string_view first = take_word(line);
    const std::string_view first_extent = take_word(line);
    const std::string_view second = take_word(line);
    const std::string_view second_extent = take_word(line);
    m_header.lines = read_axis(first, first_extent);
    m_header.length = read_axis(second, second_extent);
    if (first[1] == second[1] || !trimmed(line).empty())
      fail("the size line must name X and Y once each, like -Y 256 +X 256");
    m_header.lines_are_rows = first[1] == 'Y';
  }

  std::string_view m_text;
  const std::string& m_path;
  std::size_t m_position = 0;
  std::size_t m_line_offset = 0;
  RgbeHeader m_header;
};

} // namespace

bool is_rgbe(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.starts_with("#?RADIANCE") || text.starts_with("#?RGBE");
}

RgbeHeader read_rgbe_header(std::span<const std::byte> bytes, const std::string& path) {
  if (!is_rgbe(bytes))
    throw_input_error(path, "does not begin with #?RADIANCE or #?RGBE", 0);
  return HeaderParser(bytes, path).parse();
}

} // namespace haarlight::probe
