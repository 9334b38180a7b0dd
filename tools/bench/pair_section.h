#pragma once
// The part of the report that looks at one pair.

#include <bench/measure.h>
#include <bench/plan.h>

#include <string>

namespace haarlight::bench {

/// Convergence plots, a table of figures, and pictures with their errors.
std::string pair_html(const Plan& plan, const PairResult& pair);

} // namespace haarlight::bench
