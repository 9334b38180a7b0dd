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

/// Axis-aligned.
struct Box {
  Vec3 low = Vec3(-1, -1, -1);
  Vec3 high = Vec3(1, 1, 1); ///< above `low` in every coordinate
};

/// With both caps.
struct Cylinder {
  Vec3 base = Vec3::Zero(); ///< centre of one cap
  Vec3 top = Vec3::UnitY(); ///< centre of the other, a different point
  float radius = 1;         ///< > 0
};

/// With its base disk.
struct Cone {
  Vec3 base = Vec3::Zero();  ///< centre of the base disk
  Vec3 apex = Vec3::UnitY(); ///< a different point
  float radius = 1;          ///< of the base, > 0
};

struct Torus {
  Vec3 center = Vec3::Zero();
  Vec3 axis = Vec3::UnitY();  ///< any length but zero
  float major_radius = 1;     ///< of the centre circle, > 0
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
  Vec3 position = Vec3::Zero(); ///< projected onto the surface, exact to float rounding
  Vec3 normal = Vec3::UnitZ();  ///< unit, geometric, outward for closed shapes; of planes and disks
                                ///< as given, whichever side is hit
  int object = -1;              ///< index in the order the shapes were added
};

/// `position` offset from its surface, to the side of `direction`. Surfaces are evaluated in
/// double, so the only error of a hit is the rounding of its position (at most 0.9 ulp of the
/// largest coordinate, and the same for the offset point); the step is 2^-20 of the largest
/// coordinate, at least 4 times that error, plus 4e-9 for hits near the world's origin.
inline Vec3 offset_origin(const Vec3& position, const Vec3& normal, const Vec3& direction) {
  const float step = 0x1p-20F * (position.cwiseAbs().maxCoeff() + 0x1p-8F);
  return position + (normal.dot(direction) < 0 ? -step : step) * normal;
}

/// A ray from a hit in a unit direction, on either side of the surface.
inline Ray leave(const Hit& hit, const Vec3& direction,
                 float t_max = std::numeric_limits<float>::infinity()) {
  return {offset_origin(hit.position, hit.normal, direction), direction, t_max};
}

} // namespace haarlight::renderer
