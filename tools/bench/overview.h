#pragma once
// The part of the report that looks at all pairs at once.

#include <bench/plan.h>
#include <bench/summary.h>

#include <string>

namespace haarlight::bench {

/// Winners by pair, and how samplers do on average.
std::string overview_html(const Plan& plan, const std::vector<Verdict>& verdicts);

/// A cell of a table: figures to the right.
std::string figure_cell(const std::string& html);
std::string text_cell(const std::string& html);
std::string head_cell(const std::string& html, int columns = 1);

/// A sampler's name beside its colour, with a mark if it is biased.
std::string sampler_html(const std::string& name);

} // namespace haarlight::bench
