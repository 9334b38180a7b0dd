#pragma once
// Which of four rays from one point meet a shape, in float: near enough for estimates of what it
// hides, and many times quicker than rays one by one. <shape_canonical.h> has the exact answers.

#include <renderer/shapes/shapes.h>

namespace haarlight::renderer::detail {

/// Four vectors.
struct Lanes3 {
  Float4 x, y, z;
};

/// @param origin, directions in the solid's object frame; directions of any length
/// @return all bits of a lane where the ray meets the canonical shape (no WorldSphere); wrong only
///         within some 1e-4 of its outline, and beside a torus that the origin lies on
Int4 rays_meet(const Solid& solid, const Vec3& origin, const Lanes3& directions);

} // namespace haarlight::renderer::detail
