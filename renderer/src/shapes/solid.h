#pragma once
// Finite shapes under affine maps: their placement, and rays against the canonical shapes.

#include <renderer/shapes/shapes.h>

#include <limits>

namespace haarlight::renderer::detail {
inline constexpr double no_hit = std::numeric_limits<double>::infinity();

/// The interval of t in which a line is inside a shape.
struct Interval {
  double enter = -no_hit;
  double exit = no_hit;

  /// The first boundary with t > 0.
  double first() const {
    if (!(enter < exit))
      return no_hit;
    return enter > 0 ? enter : exit > 0 ? exit : no_hit;
  }
};

/// The interval of t in which origin + t·direction lies in [−half, half] along one axis.
Interval slab(double origin, double direction, double half);

Interval intersect(const Interval& a, const Interval& b);

/// Smallest t > 0 on the shape's surface, or no_hit.
double canonical_distance(const Solid& shape, const Eigen::Vector3d& origin,
                          const Eigen::Vector3d& direction);
double torus_distance(double tube, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// The nearest surface point to `p`, and the outward normal there (any length).
struct SurfacePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;
};
SurfacePoint canonical_surface(const Solid& shape, const Eigen::Vector3d& p);

/// Maximum of n·p over the points p of the shape, or of its convex hull for a torus.
double canonical_support(const Solid& shape, const Eigen::Vector3d& n);

/// Corners of a bounding box.
struct Bounds {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};
Bounds canonical_bounds(const Solid& shape);

/// A finite shape under a map; the caller sets the object index.
Solid place_solid(const Shape& shape, const AffineMap& transform);

/// A plane under a map; the caller sets the object index.
WorldPlane place_plane(const Plane& plane, const AffineMap& transform);

} // namespace haarlight::renderer::detail
