#pragma once
// Results of a comparison: errors of renderings against a converged reference, what samples cost,
// and rows of these figures as JSON and CSV. Errors are of luminance and of the pixels that hit an
// object only, as flat lists in the order of the film.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace haarlight::bench {

/// A run's pixels.
using Pixels = std::vector<double>;

/// Means over independent converged runs.
struct Reference {
  Pixels mean;      ///< r
  Pixels noise;     ///< variance of r, estimated from the spread of the runs
  double floor = 0; ///< ε, (1 % of the mean of r)², added to r²

  /// r² + ε of a pixel.
  double square(std::size_t pixel) const { return mean[pixel] * mean[pixel] + floor; }
};

/// @param runs two or more, all of one length
Reference reference_of(std::span<const Pixels> runs);

/// Relative variance: mean over the pixels of v / (r² + ε).
double relative_mean(const Reference& reference, const Pixels& variances);

/// Errors of several runs of one sampler that differ in their seed.
struct Quality {
  double relmse = 0; ///< mean of (x − r)² / (r² + ε), minus reference_relmse; at least 0
  double relmse_stderr = 0;     ///< standard error of it, from the spread of the runs
  double reference_relmse = 0;  ///< error of the reference: relative_mean() of its noise
  double mean_ratio = 0;        ///< Σ x / Σ r, mean over the runs; 1 = no bias
  double mean_ratio_stderr = 0; ///< of both sums, from the spread of every pixel over the runs
};

/// @param runs two or more, independent of each other and of the reference
Quality quality_of(const Reference& reference, std::span<const Pixels> runs);

/// Slope of the least-squares line through (log x, log y); −1 for errors that fall as 1/N. Points
/// that are not positive are ignored. NaN for fewer than two different x.
double log_slope(std::span<const double> x, std::span<const double> y);

/// CPU seconds of a picture by samples per pixel: linear interpolation and extrapolation of
/// measurements.
class CostModel {
public:
  void add(int spp, double seconds);

  /// CPU seconds of one additional sample per pixel, from the first to the last point; at least a
  /// twentieth of the last point's mean.
  double seconds_per_spp() const;

  /// The largest number of samples per pixel that fits a budget, from 1 to `most`. Needs two
  /// points.
  int affordable(double seconds, int most) const;

private:
  struct Point {
    double spp;
    double seconds;
  };
  std::vector<Point> m_points; ///< by rising spp
};

inline constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// One sampler at one number of samples or budget. Seconds are CPU time, summed over threads, the
/// least of the runs.
struct Row {
  std::string brdf;
  std::string probe;
  std::string scene;
  std::string sampler;
  std::string points; ///< random or sobol
  int spp = 0;
  double seconds = 0; ///< of a picture, including the preparation of pixels
  int seed_count = 0;
  double relmse = 0;
  double relvar_per_sample =
      unknown; ///< relative variance of one sample if samples are independent
  double mean_ratio = 0;
  double mean_ratio_stderr = 0;
  double seconds_per_sample = 0;   ///< of one additional sample, without preparation
  double setup_seconds = 0;        ///< once per scene, without reading files
  std::string mode;                ///< equal-samples or equal-time
  double budget_seconds = unknown; ///< of equal-time
  double efficiency = unknown;     ///< 1/(relmse · seconds)
  double slope = unknown;          ///< of log relmse over log spp, of equal-samples
  double relmse_stderr = 0;
  double reference_relmse = 0;   ///< already subtracted from relmse
  double seconds_per_point = 0;  ///< preparation of a pixel
  double precompute_seconds = 0; ///< making the .haar files that the sampler uses
  std::string claim;             ///< unbiased or biased
};

using Value = std::variant<std::string, std::int64_t, double>;

/// Names and values in the order of the columns.
std::vector<std::pair<std::string, Value>> fields_of(const Row& row);

/// A list of objects; unknown values are null.
std::string json_text(const std::vector<Row>& rows);

/// The same as CSV with a header line; unknown values are empty.
std::string csv_text(const std::vector<Row>& rows);

} // namespace haarlight::bench
