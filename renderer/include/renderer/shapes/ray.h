#pragma once
// Rays, what they hit, and how a new ray leaves a surface without hitting it again.

#include <wavelet/base/geometry.h>

#include <algorithm>
#include <limits>

namespace haarlight::renderer {

/// The points origin + t·direction, 0 < t < t_max, in world units.
struct Ray {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ(); ///< unit length
  float t_max = std::numeric_limits<float>::infinity();
};

/// The nearest surface point along a ray.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  Vec3 position = Vec3::Zero(); ///< on the surface to float rounding: reprojected, not origin + t·d
  Vec3 normal = Vec3::UnitZ(); ///< unit, geometric, out of closed shapes; a plane's and a disk's as
                               ///< given, whichever side was hit
  int object = -1;             ///< index in the order the shapes were added
};

/// `position` moved off its surface, to the side that `direction` leaves to. Surfaces are evaluated
/// in double, so the only error of a hit is the rounding of its position (at most 0.9 ulp of the
/// largest coordinate, and as much again for the moved point); the step is 2^-20 of the largest
/// coordinate, at least 4 times that, plus 1e-9 for hits near the world's origin.
inline Vec3 offset_origin(const Vec3& position, const Vec3& normal, const Vec3& direction) {
  const float step = 0x1p-20F * (position.cwiseAbs().maxCoeff() + 0x1p-8F);
  return position + (normal.dot(direction) < 0 ? -step : step) * normal;
}

/// A ray from a hit into a unit direction, on whichever side of the surface that lies.
inline Ray leave(const Hit& hit, const Vec3& direction,
                 float t_max = std::numeric_limits<float>::infinity()) {
  return {offset_origin(hit.position, hit.normal, direction), direction, t_max};
}

} // namespace haarlight::renderer
