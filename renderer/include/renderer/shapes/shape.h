#pragma once
// The analytic shapes, as plain values in world units. Closed shapes have an inside; the plane and
// the disk are two-sided and infinitely thin.

#include <wavelet/base/geometry.h>

#include <variant>

namespace haarlight::renderer {

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

} // namespace haarlight::renderer
