#pragma once
// Terms that the analytic models' values and their sampling have in common.

#include <brdf/analytic.h>

#include <wavelet/base/elementary.h>

namespace haarlight::brdf {

inline double fifth_power(double x) { return x * x * x * x * x; }

/// Schlick 1994.
inline Rgb fresnel(const Rgb& at_normal, double cosine) {
  const auto rise = static_cast<float>(fifth_power(1 - cosine));
  return at_normal + (1.0F - at_normal) * rise;
}

/// cos^n θ_h without losing the difference from one of a cosine next to it.
inline double cosine_power(const Angles& a, double n) {
  return a.cos_h > 0.7 ? exponential(0.5 * n * logarithm(1 - a.sin_h * a.sin_h))
                       : power(a.cos_h, n);
}

/// GGX's distribution of normals D, Walter et al. 2007, eq. 33.
inline double ggx_distribution(const Angles& a, double alpha2) {
  const double spread = a.sin_h * a.sin_h + alpha2 * a.cos_h * a.cos_h;
  return alpha2 / (std::numbers::pi * spread * spread);
}

/// 2 / (1 + sqrt(1 + α² tan²θ)), Walter's eq. 34, divided by cos θ.
inline double ggx_masking_over_cosine(double cosine, double alpha2) {
  return 2 / (cosine + std::sqrt(cosine * cosine + alpha2 * (1 - cosine * cosine)));
}

} // namespace haarlight::brdf
