#pragma once
// Functions that change linearly over a square: what is known of a density where no tree tells
// more.

#include <wavelet/base/lanes.h>

#include <algorithm>
#include <cmath>

namespace haarlight::wavelet {

/// 1 + x (s − ½) + y (t − ½) at (s, t) ∈ [0, 1]² of a square, |x| + |y| < 2: a linear function
/// over its mean.
struct Slope {
  float x = 0;
  float y = 0;

  float at(float s, float t) const { return 1 + x * (s - 0.5F) + y * (t - 0.5F); }

  /// Means over the quadrants q = qx + 2 qy.
  Float4 quadrants() const {
    const float a = 0.25F * x;
    const float b = 0.25F * y;
    return Float4{1 - a - b, 1 + a - b, 1 - a + b, 1 + a + b};
  }

  /// The same function over one quadrant. @param mean quadrants()[q]
  Slope in_quadrant(float mean) const { return {0.5F * x / mean, 0.5F * y / mean}; }

  /// As good as constant: it changes by less than 1/64, which is 1/50000 of variance.
  bool is_flat() const { return std::abs(x) + std::abs(y) < 1.0F / 64; }
};

namespace detail {

inline constexpr float below_one = 0x1.fffffep-1F;

/// Turns u, uniform in [0, 1), into s of density 1 + slope (s − ½).
inline float warp_linearly(float u, float slope) {
  const float start = 1 - 0.5F * slope;
  const float root = std::sqrt(std::max(start * start + 2 * slope * u, 0.0F));
  return std::min(2 * u / (start + root), below_one);
}

} // namespace detail

/// Turns a uniform point of [0, 1)² into one of the slope's density. @return that density
inline float warp(const Slope& slope, float& s, float& t) {
  s = detail::warp_linearly(s, slope.x);
  const float mean = 1 + slope.x * (s - 0.5F);
  t = detail::warp_linearly(t, slope.y / mean);
  return mean + slope.y * (t - 0.5F);
}

} // namespace haarlight::wavelet
