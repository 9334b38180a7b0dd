#pragma once
// One map of a set, as --tree names it.

#include <wavelet/tree/map_set.h>

#include <string>
#include <vector>

namespace haarlight::tool {

/// @param given  column and row, as Tool::values() read them
/// @param option that gave them, for the error
/// @throws UsageError if the set has no such map
wavelet::MapPlace chosen_map(const std::vector<double>& given, const wavelet::SetInfo& info,
                             const std::string& option);

} // namespace haarlight::tool
