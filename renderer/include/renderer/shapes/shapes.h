#pragma once
// All shapes of a scene in flat arrays, with ray intersection.
//
// Every finite shape is a canonical one (unit sphere, unit disk, cube, …) under an affine map that
// combines its placement and its transform; spheres under similarity maps and planes are kept in
// world coordinates. A ray is tested against bounding spheres in float, four at a time; candidates
// are intersected in double. Cost is linear in the number of shapes.

#include <renderer/scene/affine_map.h>
#include <renderer/shapes/shape.h>
#include <wavelet/base/lanes.h>

#include <vector>

namespace haarlight::renderer {
namespace detail {

/// The canonical shapes, about the axis z.
enum class SolidKind {
  WorldSphere, ///< not canonical: its own bounding sphere
  Sphere,      ///< |p| ≤ 1
  Disk,        ///< z = 0, x² + y² ≤ 1
  Box,         ///< |x|, |y|, |z| ≤ 1
  Cylinder,    ///< x² + y² ≤ 1, |z| ≤ 1
  Cone,        ///< x² + y² ≤ (1 − z)², 0 ≤ z ≤ 1
  Torus        ///< within `tube` of the circle of radius 1 in z = 0
};

/// A finite shape.
struct Solid {
  SolidKind kind = SolidKind::WorldSphere;
  double tube = 0;                                  ///< of a torus, in (0, 1)
  Eigen::Vector3d center = Eigen::Vector3d::Zero(); ///< of a sphere around it, world
  double radius = 0;
  AffineMap to_object;
  AffineMap to_world;
  int object = -1;
};

/// Bounding spheres of four solids, enlarged for rounding in float.
struct BoundBatch {
  Float4 x = {};
  Float4 y = {};
  Float4 z = {};
  Float4 radius_squared = {};
};

struct WorldPlane {
  Eigen::Vector3d normal; ///< unit
  double height;          ///< normal·p of its points
  int object;
};

} // namespace detail

/// Thread-safe once built.
class ShapeSet {
public:
  /// @param shape     obeys the ranges in <renderer/shapes/shape.h>
  /// @param transform applied to the shape in world space; usable()
  /// @return the object index of its hits: 0, 1, 2, …
  int add(const Shape& shape, const AffineMap& transform = {});

  int size() const { return static_cast<int>(m_solids.size() + m_planes.size()); }

  /// The nearest hit with 0 < t < min(ray.t_max, 1e30); false and `hit` untouched if there is none.
  bool intersect(const Ray& ray, Hit& hit) const;

  /// Whether anything is hit with 0 < t < min(ray.t_max, 1e30); the same result as intersect(),
  /// faster.
  bool occluded(const Ray& ray) const;

  /// Whether an object may be shadowed by another object or by itself.
  bool may_occlude(int object) const;

  /// The finite shapes and the planes.
  const std::vector<detail::Solid>& solids() const { return m_solids; }
  const std::vector<detail::WorldPlane>& planes() const { return m_planes; }

private:
  void add_solid(detail::Solid solid);

  std::vector<detail::BoundBatch> m_bounds; // of m_solids, in order
  std::vector<detail::Solid> m_solids;
  std::vector<detail::WorldPlane> m_planes;
};

} // namespace haarlight::renderer
