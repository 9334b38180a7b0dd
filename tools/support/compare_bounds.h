#pragma once
// How far two sets may lie apart, as the command line bounds it.

#include <support/tool.h>

#include <wavelet/tree/compare.h>

#include <optional>
#include <string>

namespace haarlight::tool {

struct CompareBounds {
  std::optional<double> l2, relative_l2, linf, mean_error; ///< at most
  std::optional<double> psnr;                              ///< at least, dB
};

/// Declares --max-l2, --max-relative-l2, --max-linf, --max-mean-error and --min-psnr.
void add_compare_bounds(Tool& tool, CompareBounds& bounds);

/// Holds a result against the bounds given and adds a row "bounds" to the report for each.
/// @return which were broken and by how much, in one line; empty if all hold
std::string judge(const wavelet::SetDifference& result, const CompareBounds& bounds,
                  Report& report);

} // namespace haarlight::tool
