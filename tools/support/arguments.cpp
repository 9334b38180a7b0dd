#include <support/arguments.h>

#include <support/report.h>
#include <support/tool.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace haarlight::tool {
namespace {

template <class T>
T parsed(const std::string& word, const char* wanted) {
  T result{};
  const char* end = word.data() + word.size();
  const auto [stop, fault] = std::from_chars(word.data(), end, result);
  if (fault == std::errc::result_out_of_range)
    throw UsageError("'" + word + "' is too large or too small a number");
  if (fault != std::errc() || stop != end)
    throw UsageError("'" + word + "' is not " + wanted);
  return result;
}

[[noreturn]] void refuse(const std::string& word, const std::string& low, const std::string& high) {
  throw UsageError("'" + word + "' is out of range, from " + low + " to " + high + " is needed");
}

} // namespace

std::int64_t parse_integer(const std::string& word, std::int64_t low, std::int64_t high) {
  const auto number = parsed<std::int64_t>(word, "a whole number");
  if (number < low || number > high)
    refuse(word, std::to_string(low), std::to_string(high));
  return number;
}

std::uint64_t parse_unsigned(const std::string& word) {
  return parsed<std::uint64_t>(word, "a whole number from 0 up");
}

double parse_number(const std::string& word, double low, double high) {
  const auto number = parsed<double>(word, "a number");
  if (!std::isfinite(number))
    throw UsageError("'" + word + "' is not a finite number");
  if (number < low || number > high)
    refuse(word, short_text(low), short_text(high));
  return number;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::vector<double> parse_numbers(const std::string& word, std::size_t count, double low,
                                  double high) {
  std::vector<double> numbers;
  for (const std::string& number : split(word))
    numbers.push_back(parse_number(number, low, high));
  if (numbers.size() != count)
    throw UsageError("'" + word + "' is not " + std::to_string(count) +
                     " numbers separated by commas");
  return numbers;
}

bool has_extension(const std::string& path, const std::string& extension) {
  return path.size() > extension.size() && path.ends_with(extension);
}

void check_picture_path(const std::string& path, const std::string& option) {
  if (!path.empty() && path != "-" && !has_extension(path, ".png") && !has_extension(path, ".exr"))
    throw UsageError(option + ": '" + path + "' ends in neither .png nor .exr");
}

wavelet::MapPlace chosen_map(const std::vector<double>& given, const wavelet::SetInfo& info,
                             const std::string& option) {
  const double column = given[0];
  const double row = given[1];
  if (column != std::floor(column) || row != std::floor(row) || column >= info.columns ||
      row >= info.rows)
    throw UsageError(option + ": the set has columns 0 to " + std::to_string(info.columns - 1) +
                     " and rows 0 to " + std::to_string(info.rows - 1));
  return {static_cast<int>(column), static_cast<int>(row)};
}

} // namespace haarlight::tool
