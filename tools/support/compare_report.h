#pragma once
// What haardiff reports.

#include <support/compare_input.h>
#include <support/report.h>

#include <wavelet/tree/compare.h>

namespace haarlight::tool {

Report describe(const wavelet::SetDifference& result, const CompareInput& input,
                const ComparedSets& sets);

} // namespace haarlight::tool
