#include <support/words.h>

#include <support/tool.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

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

std::int64_t integer_of(const std::string& word, std::int64_t low, std::int64_t high) {
  const auto number = parsed<std::int64_t>(word, "a whole number");
  if (number < low || number > high)
    refuse(word, std::to_string(low), std::to_string(high));
  return number;
}

std::uint64_t natural_of(const std::string& word) {
  return parsed<std::uint64_t>(word, "a whole number from 0 up");
}

double number_of(const std::string& word, double low, double high) {
  const auto number = parsed<double>(word, "a number");
  if (!std::isfinite(number))
    throw UsageError("'" + word + "' is not a finite number");
  if (number < low || number > high)
    refuse(word, short_text(low), short_text(high));
  return number;
}

std::vector<double> numbers_of(const std::string& word, std::size_t count, double low,
                               double high) {
  std::vector<double> numbers;
  for (std::size_t begin = 0; begin <= word.size();) {
    const std::size_t end = std::min(word.find(',', begin), word.size());
    numbers.push_back(number_of(word.substr(begin, end - begin), low, high));
    begin = end + 1;
  }
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

std::string short_text(double number) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.6g", number);
  return buffer.data();
}

std::string exact_text(double number) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  return {buffer.data(), result.ptr};
}

std::string size_text(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> units = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto amount = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; amount >= 1024 && unit + 1 < units.size(); ++unit)
    amount /= 1024;
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), unit == 0 ? "%.0f %s" : "%.2f %s", amount,
                units[unit]);
  return buffer.data();
}

} // namespace haarlight::tool
