#pragma once
// The analytic shapes as plain values in world units, rays, and the points where rays hit shapes.

#include <wavelet/base/geometry.h>

#include <algorithm>
#include <limits>
#include <variant>

namespace haarlight::renderer {

// Closed shapes have an inside; the plane and the disk are two-sided and infinitely thin.

struct Sphere {
  Vec3 center = Vec3::Zero();
  float radius = 1; ///< > 0
};

/// Infinite.
struct Plane {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitY(); ///< any length but zero
};

struct Disk {
  Vec3 center = Vec3::Zero();
  Vec3 normal = Vec3::UnitY(); ///< any length but zero
  float radius = 1;            ///< > 0
};

/// Edges along the axes; turn it by a transform.
struct Box {
  Vec3 low = Vec3(-1, -1, -1);
  Vec3 high = Vec3(1, 1, 1); ///< beyond `low` in every coordinate
};

/// With both caps.
struct Cylinder {
  Vec3 base = Vec3::Zero(); ///< centre of one cap
  Vec3 top = Vec3::UnitY(); ///< centre of the other, elsewhere
  float radius = 1;         ///< > 0
};

/// With its base disk.
struct Cone {
  Vec3 base = Vec3::Zero();  ///< centre of the base disk
  Vec3 apex = Vec3::UnitY(); ///< elsewhere
  float radius = 1;          ///< of the base, > 0
};

/// A ring about an axis.
struct Torus {
  Vec3 center = Vec3::Zero();
  Vec3 axis = Vec3::UnitY();  ///< any length but zero
  float major_radius = 1;     ///< of the circle the tube follows, > 0
  float minor_radius = 0.25F; ///< of the tube, > 0 and below the major radius
};

using Shape = std::variant<Sphere, Plane, Disk, Box, Cylinder, Cone, Torus>;

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
