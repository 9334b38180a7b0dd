#pragma once
// Words of a command line as numbers, and back: strict, and the same in every locale.

#include <cstdint>
#include <string>
#include <vector>

namespace haarlight::tool {

/// All throw UsageError, saying what would be right, if `word` is no number or out of [low, high].
std::int64_t integer_of(const std::string& word, std::int64_t low, std::int64_t high);
std::uint64_t natural_of(const std::string& word);
double number_of(const std::string& word, double low, double high);
std::vector<double> numbers_of(const std::string& word, std::size_t count, double low, double high);

/// True if there is a name and it ends so, as in ".haar".
bool has_extension(const std::string& path, const std::string& extension);

/// Nothing for an empty path and for standard output. @param option for the error
/// @throws UsageError if `path` ends in neither .png nor .exr
void check_picture_path(const std::string& path, const std::string& option);

/// Six significant digits, as in 0.00123 or 1.5e-07.
std::string short_text(double number);
/// Enough digits to read the same number back.
std::string exact_text(double number);
/// Bytes as in `1.25 MiB`.
std::string size_text(std::uint64_t bytes);

} // namespace haarlight::tool
