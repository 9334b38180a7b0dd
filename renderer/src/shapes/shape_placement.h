#pragma once
// From the shapes of a scene to what rays are held against.

#include <renderer/shapes/shapes.h>

namespace haarlight::renderer::detail {

/// A finite shape under a transform; its object index is left to the caller.
Solid place_solid(const Shape& shape, const AffineMap& transform);

/// A plane under a transform, likewise.
WorldPlane place_plane(const Plane& plane, const AffineMap& transform);

} // namespace haarlight::renderer::detail
