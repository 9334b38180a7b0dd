#pragma once
// Who wins.

#include <bench/results.h>

#include <support/report.h>

#include <string>
#include <vector>

namespace haarlight::bench {

/// The best of the samplers that were compared at one number of samples or one budget.
struct Verdict {
  const Row* winner = nullptr;       ///< of least relmse
  double product_over_mis = unknown; ///< 1/relmse of product over that of mis, if both took part:
                                     ///< how many times less error product makes
  std::vector<const Row*> rows;      ///< all that took part
};

/// One for each pair, scene, kind of points, mode and spp or budget, in the order of the rows.
/// @param rows must outlive the result
std::vector<Verdict> verdicts_of(const std::vector<Row>& rows);

/// What haarbench prints: lists "equal_samples" and "equal_time" of verdicts; product_over_mis only
/// where both took part.
tool::Report describe(const std::vector<Verdict>& verdicts);

} // namespace haarlight::bench
