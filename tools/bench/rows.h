#pragma once
// The figures of a comparison, one row for each sampler at each number of samples or budget.

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace haarlight::bench {

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Seconds are CPU time, summed over threads; of runs that differ in their seed the least.
struct Row {
  std::string brdf;
  std::string probe;
  std::string scene;
  std::string sampler;
  std::string points; ///< random or sobol
  int spp = 0;
  double seconds = 0; ///< of a film, with each pixel's preparation
  int seed_count = 0;
  double relmse = 0;
  double relvar_per_sample = unknown; ///< relative variance of one sample, random points supposed
  double mean_ratio = 0;
  double mean_ratio_stderr = 0;
  double seconds_per_sample = 0;   ///< of one more, preparation apart
  double setup_seconds = 0;        ///< once for a scene, beyond reading files
  std::string mode;                ///< equal-samples or equal-time
  double budget_seconds = unknown; ///< of equal-time
  double efficiency = unknown;     ///< 1/(relmse · seconds)
  double slope = unknown;          ///< of log relmse over log spp, of equal-samples
  double relmse_stderr = 0;
  double reference_relmse = 0;   ///< already taken off relmse
  double seconds_per_point = 0;  ///< what is left of a pixel: its preparation
  double precompute_seconds = 0; ///< making the .haar files that the sampler uses
  std::string claim;             ///< unbiased or biased
};

using Value = std::variant<std::string, std::int64_t, double>;

/// Names and values in the order of the columns.
std::vector<std::pair<std::string, Value>> fields_of(const Row& row);

/// A list of objects; what is unknown is null.
std::string json_text(const std::vector<Row>& rows);

/// The same with a line of names; what is unknown is empty.
std::string csv_text(const std::vector<Row>& rows);

} // namespace haarlight::bench
