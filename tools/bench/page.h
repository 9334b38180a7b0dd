#pragma once
// The report: one HTML file that needs nothing but itself.

#include <bench/measure.h>
#include <bench/plan.h>
#include <bench/summary.h>

#include <string>
#include <vector>

namespace haarlight::bench {

std::string page_html(const Plan& plan, const std::vector<PairResult>& pairs,
                      const std::vector<Verdict>& verdicts);

} // namespace haarlight::bench
