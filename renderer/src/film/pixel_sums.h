#pragma once
// Sums over a pixel's samples, enough for every estimator and its variance.

#include <renderer/film/render.h>

#include <span>

namespace haarlight::renderer {

/// A sample's contribution, for estimates of the variance.
struct Contribution {
  double luminance = 0; ///< of w = f_r L cos / p, the unshadowed contribution
  bool visible = false;
  Technique technique = Technique::First;
  FirstWeights first = {};
};

/// Estimates the variances of Σ w v and Σ w over the independent samples of a pass: unbiased for
/// random points and at least two samples. If a technique drew a single sample, the estimate may be
/// negative. Directions that are the same for every seed have no variance.
SumVariance variance_of_sums(std::span<const Contribution> samples);

/// w = f_r L cos / p is a sample's unshadowed contribution, v ∈ {0, 1} its visibility.
struct PixelSums {
  Rgb shadowed = Rgb::Zero();       ///< Σ w v
  Rgb unshadowed = Rgb::Zero();     ///< Σ w
  Rgb emitted = Rgb::Zero();        ///< by the visible surface; added to every estimate
  Rgb product = Rgb::Zero();        ///< L_ns of the product, as of the last pass
  SumVariance variance;             ///< of Σ w v and Σ w over the passes of two or more samples
  std::uint32_t variance_count = 0; ///< samples of these passes
  double pdf = 0;                   ///< Σ p
  std::uint32_t count = 0;
  std::uint32_t directions = 0; ///< above the horizon, for the bidirectional estimator
  std::uint32_t visible = 0;    ///< of those, unoccluded

  void add(const Rgb& weight, bool v, float p);

  /// Adds a direction above the horizon, for the bidirectional estimator.
  void add_direction(bool v);

  /// Adds the variance of a pass's sums. Passes of one sample are ignored.
  /// @param samples of the pass
  void add_variance(const SumVariance& of_pass, std::uint32_t samples);
};

/// A pixel's radiance.
Rgb estimate(const PixelSums& sums, Estimator estimator);

/// Estimated variance of its luminance. Passes of a single sample are assumed to vary like the
/// others; 0 if there are no others. Unbiased for the unbiased estimator and random points; may be
/// negative if a technique drew a single sample.
double estimate_variance(const PixelSums& sums, Estimator estimator);

} // namespace haarlight::renderer
