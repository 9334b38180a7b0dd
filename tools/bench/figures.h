#pragma once
// From runs to rows.

#include <bench/rows.h>
#include <bench/session.h>
#include <bench/statistics.h>

#include <string>
#include <vector>

namespace haarlight::bench {

/// @param common what all rows of a sampler have in common
/// @param mode   equal-samples or equal-time
Row row_of(const Row& common, const std::string& mode, const Runs& runs,
           const Reference& reference);

/// Gives all rows the slope of their error over their samples.
void set_slopes(std::vector<Row>& rows);

} // namespace haarlight::bench
