#include <bench/figures.h>

#include <algorithm>

namespace haarlight::bench {

Row row_of(const Row& common, const std::string& mode, const Runs& runs,
           const Reference& reference) {
  const Quality quality = quality_of(reference, runs.luminances);
  Row row = common;
  row.mode = mode;
  row.spp = runs.spp;
  row.seconds = runs.seconds;
  row.seed_count = static_cast<int>(runs.luminances.size());
  row.relmse = quality.relmse;
  row.relmse_stderr = quality.relmse_stderr;
  row.reference_relmse = quality.reference_relmse;
  row.mean_ratio = quality.mean_ratio;
  row.mean_ratio_stderr = quality.mean_ratio_stderr;
  if (runs.spp > 1)
    row.relvar_per_sample = runs.spp * relative_mean(reference, runs.variances);
  const auto points = static_cast<double>(runs.pixels.size());
  row.seconds_per_point =
      std::max(0.0, row.seconds / points - runs.spp * common.seconds_per_sample);
  if (row.relmse * row.seconds > 0)
    row.efficiency = 1 / (row.relmse * row.seconds);
  return row;
}

void set_slopes(std::vector<Row>& rows) {
  std::vector<double> spps;
  std::vector<double> errors;
  spps.reserve(rows.size());
  errors.reserve(rows.size());
  for (const Row& row : rows) {
    spps.push_back(row.spp);
    errors.push_back(row.relmse);
  }
  for (Row& row : rows)
    row.slope = log_slope(spps, errors);
}

} // namespace haarlight::bench
