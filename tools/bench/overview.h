#pragma once
// The part of the report that looks at all pairs at once.

#include <bench/plan.h>
#include <bench/summary.h>

#include <string>

namespace haarlight::bench {

/// Winners by pair, and how samplers do on average.
std::string overview_html(const Plan& plan, const std::vector<Verdict>& verdicts);

} // namespace haarlight::bench
