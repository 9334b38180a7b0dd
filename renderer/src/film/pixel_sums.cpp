#include "film/pixel_sums.h"

#include <algorithm>

namespace haarlight::renderer {

void TechniqueSums::add(const TechniqueSums& other) {
  count += other.count;
  shadowed += other.shadowed;
  unshadowed += other.unshadowed;
  shadowed_square += other.shadowed_square;
  square += other.square;
}

void PixelSums::add(const Rgb& weight, bool v, float p, Technique technique) {
  unshadowed += weight;
  if (v)
    shadowed += weight;
  pdf += static_cast<double>(p);
  ++count;
  if (technique == Technique::Fixed)
    return;
  const auto y = static_cast<double>(luminance(weight));
  techniques[static_cast<std::size_t>(technique)].add({1, v ? y : 0, y, v ? y * y : 0, y * y});
}

void PixelSums::add_direction(bool v) {
  ++directions;
  visible += v ? 1 : 0;
}

void PixelSums::add_shared(const SumVariance& variance) {
  shared.shadowed += variance.shadowed;
  shared.covariance += variance.covariance;
  shared.unshadowed += variance.unshadowed;
}

namespace {

/// Of eq. 9 in the paper. Directions below the horizon say nothing of occlusion; where there are no
/// others, none is assumed, and likewise by the ratio estimator where no sample has a weight.
float visible_fraction(const PixelSums& sums) {
  return sums.directions > 0
             ? static_cast<float>(sums.visible) / static_cast<float>(sums.directions)
             : 1.0F;
}

Rgb estimate_reflected(const PixelSums& sums, Estimator estimator) {
  if (sums.count == 0)
    return Rgb::Zero();
  const auto n = static_cast<float>(sums.count);
  switch (estimator) {
  case Estimator::Unbiased:
    return sums.shadowed / n;
  case Estimator::Bidirectional:
    return sums.product * visible_fraction(sums);
  case Estimator::Ratio:
    return sums.product * (sums.unshadowed > 0).select(sums.shadowed / sums.unshadowed, 1.0F);
  }
  return Rgb::Zero();
}

/// Adds the variance of a technique's sums, n times that of its samples.
void add_variance(const TechniqueSums& t, SumVariance& sum) {
  if (t.count < 2)
    return;
  const double n = t.count;
  const double scale = n / (n - 1);
  sum.shadowed += scale * (t.shadowed_square - t.shadowed * t.shadowed / n);
  sum.covariance += scale * (t.shadowed_square - t.shadowed * t.unshadowed / n);
  sum.unshadowed += scale * (t.square - t.unshadowed * t.unshadowed / n);
}

/// Variances of Σ w v and Σ w.
SumVariance variance_of_sums(const PixelSums& sums) {
  SumVariance result = sums.shared;
  if (std::ranges::any_of(sums.techniques, [](const auto& t) { return t.count == 1; })) {
    TechniqueSums mixture;
    for (const TechniqueSums& t : sums.techniques)
      mixture.add(t);
    add_variance(mixture, result);
  } else {
    for (const TechniqueSums& t : sums.techniques)
      add_variance(t, result);
  }
  return result;
}

} // namespace

Rgb estimate(const PixelSums& sums, Estimator estimator) {
  return sums.emitted + estimate_reflected(sums, estimator);
}

double estimate_variance(const PixelSums& sums, Estimator estimator) {
  if (sums.count < 2)
    return 0;
  const auto product = static_cast<double>(luminance(sums.product));
  if (estimator == Estimator::Bidirectional) {
    const auto fraction = static_cast<double>(visible_fraction(sums));
    return product * product * fraction * (1 - fraction) / std::max(1.0, sums.directions - 1.0);
  }
  const SumVariance variance = variance_of_sums(sums);
  const double n = sums.count;
  if (estimator == Estimator::Unbiased)
    return std::max(0.0, variance.shadowed / (n * n));
  const auto whole = static_cast<double>(luminance(sums.unshadowed));
  if (!(whole > 0))
    return 0;
  // By the delta method, from the residuals w v − ratio·w.
  const double ratio = static_cast<double>(luminance(sums.shadowed)) / whole;
  const double residual =
      variance.shadowed - 2 * ratio * variance.covariance + ratio * ratio * variance.unshadowed;
  return std::max(0.0, residual) * product * product / (whole * whole);
}

} // namespace haarlight::renderer
