#pragma once
// What a pixel gathers over its samples, enough for every estimator and its variance.

#include <renderer/render.h>

namespace haarlight::renderer {

/// w = f_r L cos / p is a sample's unshadowed contribution, v ∈ {0, 1} its visibility.
struct PixelSums {
  Rgb shadowed = Rgb::Zero();   ///< Σ w v
  Rgb unshadowed = Rgb::Zero(); ///< Σ w
  Rgb emitted = Rgb::Zero();    ///< by what is seen; adds to every estimate
  Rgb product = Rgb::Zero();    ///< L_ns of the product, as of the last pass
  double shadowed_square = 0;   ///< Σ (lum w)² v
  double square = 0;            ///< Σ (lum w)²
  double pdf = 0;               ///< Σ p
  std::uint32_t visible = 0;
  std::uint32_t count = 0;

  void add(const Rgb& weight, bool v, float p);
};

/// A pixel's radiance.
Rgb estimate(const PixelSums& sums, Estimator estimator);

/// Estimated variance of its luminance; 0 with fewer than two samples.
double estimate_variance(const PixelSums& sums, Estimator estimator);

} // namespace haarlight::renderer
