#pragma once
// How far renderings lie from a converged reference. Everything is of luminance, and of the pixels
// that hit an object only, as flat lists in the order of the film.

#include <span>
#include <vector>

namespace haarlight::bench {

/// A run's pixels.
using Pixels = std::vector<double>;

/// Means over independent converged runs.
struct Reference {
  Pixels mean;      ///< r
  Pixels noise;     ///< variance of r, estimated from the spread of the runs
  double floor = 0; ///< ε, (1 % of the mean of r)²: what r² is never taken to be below

  /// r² + ε of a pixel.
  double square(std::size_t pixel) const { return mean[pixel] * mean[pixel] + floor; }
};

/// @param runs two or more, all of one length
Reference reference_of(std::span<const Pixels> runs);

/// Mean over the pixels of v / (r² + ε): how variances become relative ones.
double relative_mean(const Reference& reference, const Pixels& variances);

/// What several runs of one sampler, alike but for their seeds, say of it.
struct Quality {
  double relmse = 0;        ///< mean of (x − r)² / (r² + ε), less reference_relmse; at least 0
  double relmse_stderr = 0; ///< standard error of it, from the spread of the runs
  double reference_relmse = 0;  ///< the reference's own share: relative_mean() of its noise
  double mean_ratio = 0;        ///< Σ x / Σ r, mean over the runs; 1 = no bias
  double mean_ratio_stderr = 0; ///< of both sums, from the spread of every pixel over the runs
};

/// @param runs two or more, independent of each other and of the reference
Quality quality_of(const Reference& reference, std::span<const Pixels> runs);

/// Slope of the least-squares line through (log x, log y); −1 for errors that fall as 1/N.
/// Not-a-number with fewer than two different x, points that are not positive not counted.
double log_slope(std::span<const double> x, std::span<const double> y);

/// What a film costs by its samples per pixel, from measured points: straight between them and
/// beyond.
class CostModel {
public:
  void add(int spp, double seconds);

  /// Of one more sample per pixel, from the first to the last point; at least a twentieth of the
  /// last point's mean.
  double seconds_per_spp() const;

  /// The most samples per pixel that fit a budget, from 1 to `most`. After two points or more.
  int affordable(double seconds, int most) const;

private:
  struct Point {
    double spp;
    double seconds;
  };
  std::vector<Point> m_points; ///< by rising spp
};

} // namespace haarlight::bench
