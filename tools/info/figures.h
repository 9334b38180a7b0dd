#pragma once
// The page's pictures of the set, and its figures of coefficients.

#include <support/inspect.h>

#include <wavelet/file/tree_set.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::info {

/// All maps side by side, or the one map if there is one; as fine as 1024 pixels a side allow.
/// @param trees all of the set, or one
std::string atlas_html(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& trees,
                       std::optional<int> level);

/// Bars of coefficients and of energy by level.
std::string level_bars_html(const tool::TreeFigures& sum, std::size_t trees);

/// The error that is left by the number of coefficients kept.
std::string error_curve_html(const wavelet::TreeSet& set,
                             const std::vector<wavelet::MapPlace>& trees);

} // namespace haarlight::info
