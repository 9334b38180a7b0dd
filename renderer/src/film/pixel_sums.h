#pragma once
// Sums over a pixel's samples, enough for every estimator and its variance.

#include <renderer/film/render.h>

#include <array>

namespace haarlight::renderer {

/// Of the samples that one technique drew, luminances: independent and identically distributed if
/// points are random.
struct TechniqueSums {
  std::uint32_t count = 0;
  double shadowed = 0;        ///< Σ w v
  double unshadowed = 0;      ///< Σ w
  double shadowed_square = 0; ///< Σ w² v
  double square = 0;          ///< Σ w²

  void add(const TechniqueSums& other);
};

/// w = f_r L cos / p is a sample's unshadowed contribution, v ∈ {0, 1} its visibility.
struct PixelSums {
  Rgb shadowed = Rgb::Zero();   ///< Σ w v
  Rgb unshadowed = Rgb::Zero(); ///< Σ w
  Rgb emitted = Rgb::Zero();    ///< by the visible surface; adds to every estimate
  Rgb product = Rgb::Zero();    ///< L_ns of the product, as of the last pass
  std::array<TechniqueSums, random_techniques> techniques;
  SumVariance shared; ///< of Σ w v and Σ w, besides that of independent samples
  double pdf = 0;     ///< Σ p
  std::uint32_t count = 0;
  std::uint32_t directions = 0; ///< above the horizon, for the bidirectional estimator
  std::uint32_t visible = 0;    ///< of those, unoccluded

  void add(const Rgb& weight, bool v, float p, Technique technique);

  /// For the bidirectional estimator: a direction above the horizon.
  void add_direction(bool v);

  /// Adds the variance that a pass's samples share.
  void add_shared(const SumVariance& variance);
};

/// A pixel's radiance.
Rgb estimate(const PixelSums& sums, Estimator estimator);

/// Estimated variance of its luminance; 0 with fewer than two samples. A technique of a single
/// sample has no variance of its own: all samples are then taken as draws of one mixture, which
/// adds the variance between the techniques' means.
double estimate_variance(const PixelSums& sums, Estimator estimator);

} // namespace haarlight::renderer
