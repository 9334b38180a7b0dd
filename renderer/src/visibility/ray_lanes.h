#pragma once
// Approximate intersection of four rays from one point with a shape, in float: accurate enough for
// visible fractions, and many times faster than the exact intersection in shapes/solid.h.

#include <renderer/shapes/shapes.h>

namespace haarlight::renderer::detail {

/// Four vectors.
struct Lanes3 {
  Float4 x, y, z;
};

/// @param origin, directions in the solid's object frame; directions of any length
/// @return all bits of a lane set where the ray hits the canonical shape (not WorldSphere); errors
///         occur only within about 1e-4 of the outline, and next to a torus that the origin lies on
Int4 rays_hit(const Solid& solid, const Vec3& origin, const Lanes3& directions);

} // namespace haarlight::renderer::detail
