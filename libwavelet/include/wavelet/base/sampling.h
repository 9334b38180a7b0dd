#pragma once
// Mappings from points of the unit square to directions and points of other shapes.

#include <wavelet/base/geometry.h>
#include <wavelet/base/trigonometry.h>

namespace haarlight {

/// Uniform in the unit disk: radius √u.x, azimuth 2π u.y.
inline Vec2 sample_disk(const Vec2& u) {
  Vec2 direction;
  sine_cosine(2 * pi * u.y(), direction.y(), direction.x());
  return std::sqrt(u.x()) * direction;
}

/// Unit vector about z with the density cos θ / π (sr⁻¹).
inline Vec3 sample_cosine_hemisphere(const Vec2& u) {
  const Vec2 p = sample_disk(u);
  return {p.x(), p.y(), std::sqrt(1 - u.x())};
}

/// Density of sample_cosine_hemisphere() at a unit vector, sr⁻¹; 0 below the horizon.
inline float cosine_hemisphere_pdf(const Vec3& w) { return w.z() > 0 ? w.z() / pi : 0.0F; }

} // namespace haarlight
