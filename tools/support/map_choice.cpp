#include <support/map_choice.h>

#include <support/tool.h>

#include <cmath>

namespace haarlight::tool {

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
