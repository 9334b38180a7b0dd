#pragma once
// Values of command-line arguments: numbers, paths, indices of maps. Parsing is strict and the same
// in every locale.

#include <wavelet/tree/map_set.h>

#include <cstdint>
#include <string>
#include <vector>

namespace haarlight::tool {

/// @throws UsageError, with the expected form, if `word` is no number or is outside [low, high]
std::int64_t parse_integer(const std::string& word, std::int64_t low, std::int64_t high);
std::uint64_t parse_unsigned(const std::string& word);
double parse_number(const std::string& word, double low, double high);
std::vector<double> parse_numbers(const std::string& word, std::size_t count, double low,
                                  double high);

/// The words between commas; of an empty text one empty word.
std::vector<std::string> split(const std::string& text);

/// True for a non-empty name followed by an extension as in ".haar".
bool has_extension(const std::string& path, const std::string& extension);

/// Accepts .png, .exr, an empty path and standard output. @param option for the error
/// @throws UsageError for any other extension
void check_picture_path(const std::string& path, const std::string& option);

/// One map of a set. @param given column and row, as Tool::values() parses them
/// @param option for the error. @throws UsageError if the set has no such map
wavelet::MapPlace chosen_map(const std::vector<double>& given, const wavelet::SetInfo& info,
                             const std::string& option);

} // namespace haarlight::tool
