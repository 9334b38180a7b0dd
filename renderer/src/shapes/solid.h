#pragma once
// Finite shapes under affine maps: their placement, and rays against the canonical shapes.

#include <renderer/shapes/shapes.h>

#include <limits>

namespace haarlight::renderer::detail {
inline constexpr double no_hit = std::numeric_limits<double>::infinity();

/// The values of t a line spends inside something.
struct Interval {
  double enter = -no_hit;
  double exit = no_hit;

  /// The first boundary with t > 0, as seen by a ray that starts at t = 0.
  double first() const {
    if (!(enter < exit))
      return no_hit;
    return enter > 0 ? enter : exit > 0 ? exit : no_hit;
  }
};

/// Where origin + t·direction lies within [−half, half] along one axis.
Interval slab(double origin, double direction, double half);

Interval intersect(const Interval& a, const Interval& b);

/// Smallest t > 0 on the shape's surface, or no_hit.
double canonical_distance(const Solid& shape, const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction);
double torus_distance(double tube, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// The surface point next to `p`, and the outward normal there (any length).
struct SurfacePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;
};
SurfacePoint canonical_surface(const Solid& shape, const Eigen::Vector3d& p);

/// Largest n·p over the points p of the shape; of a torus, and of no other, that is of its hull.
double canonical_support(const Solid& shape, const Eigen::Vector3d& n);

/// Corners of a box around the shape.
struct Bounds {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};
Bounds canonical_bounds(const Solid& shape);

/// A finite shape under a transform; its object index is left to the caller.
Solid place_solid(const Shape& shape, const AffineMap& transform);

/// A plane under a transform, likewise.
WorldPlane place_plane(const Plane& plane, const AffineMap& transform);

} // namespace haarlight::renderer::detail
