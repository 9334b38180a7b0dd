#include "pixel_sums.h"

#include <algorithm>

namespace haarlight::renderer {

void PixelSums::add(const Rgb& weight, bool v, float p) {
  const auto y = static_cast<double>(luminance(weight));
  unshadowed += weight;
  square += y * y;
  pdf += static_cast<double>(p);
  ++count;
  if (!v)
    return;
  shadowed += weight;
  shadowed_square += y * y;
  ++visible;
}

namespace {

Rgb estimate_reflected(const PixelSums& sums, Estimator estimator) {
  if (sums.count == 0)
    return Rgb::Zero();
  const auto n = static_cast<float>(sums.count);
  switch (estimator) {
  case Estimator::Unbiased:
    return sums.shadowed / n;
  case Estimator::Bidirectional:
    return sums.product * (static_cast<float>(sums.visible) / n);
  case Estimator::Ratio:
    return (sums.unshadowed > 0).select(sums.product * sums.shadowed / sums.unshadowed, 0.0F);
  }
  return Rgb::Zero();
}

} // namespace

Rgb estimate(const PixelSums& sums, Estimator estimator) {
  return sums.emitted + estimate_reflected(sums, estimator);
}

double estimate_variance(const PixelSums& sums, Estimator estimator) {
  if (sums.count < 2)
    return 0;
  const double n = sums.count;
  const auto shadowed = static_cast<double>(luminance(sums.shadowed));
  const auto product = static_cast<double>(luminance(sums.product));
  if (estimator == Estimator::Unbiased)
    return std::max(0.0, (sums.shadowed_square - shadowed * shadowed / n) / (n * (n - 1)));
  if (estimator == Estimator::Bidirectional) {
    const double share = sums.visible / n;
    return product * product * share * (1 - share) / (n - 1);
  }
  const auto whole = static_cast<double>(luminance(sums.unshadowed));
  if (!(whole > 0))
    return 0;
  const double ratio = shadowed / whole; // residuals w v − ratio·w, by the delta method
  const double residual = sums.shadowed_square * (1 - 2 * ratio) + ratio * ratio * sums.square;
  return std::max(0.0, residual) * product * product / (whole * whole) * n / (n - 1);
}

} // namespace haarlight::renderer
