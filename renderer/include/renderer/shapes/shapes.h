#pragma once
// All shapes of a scene in flat arrays, and the two questions rays ask of them.
//
// Every finite shape becomes a canonical one (unit sphere, unit disk, cube, …) under one affine
// map, which holds both its own placement and its transform; spheres that stay spheres and planes
// are kept in world coordinates. A ray is first held against bounding spheres, four at a time in
// float; what passes is intersected in double. See <renderer/shapes/shape.h> for how a ray leaves a
// surface. Cost grows linearly with the number of shapes.

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

/// Bounding spheres of four solids, padded for the rounding of float.
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

/// Built once, then asked from any number of threads.
class ShapeSet {
public:
  /// @param shape     obeys the ranges in <renderer/shapes/shape.h>
  /// @param transform applied to the shape where it stands; usable()
  /// @return the object index its hits will carry: 0, 1, 2, …
  int add(const Shape& shape, const AffineMap& transform = {});

  int size() const { return static_cast<int>(m_solids.size() + m_planes.size()); }

  /// The nearest hit with 0 < t < min(ray.t_max, 1e30); false and `hit` untouched if there is none.
  bool intersect(const Ray& ray, Hit& hit) const;

  /// Whether anything is hit with 0 < t < min(ray.t_max, 1e30): answers as intersect() does,
  /// sooner.
  bool occluded(const Ray& ray) const;

  /// Whether light on an object may be in another's shadow or its own.
  bool may_occlude(int object) const;

  /// What rays are held against: the shapes that are finite, and the planes.
  const std::vector<detail::Solid>& solids() const { return m_solids; }
  const std::vector<detail::WorldPlane>& planes() const { return m_planes; }

private:
  void add_solid(detail::Solid solid);

  std::vector<detail::BoundBatch> m_bounds; // of m_solids, in order
  std::vector<detail::Solid> m_solids;
  std::vector<detail::WorldPlane> m_planes;
};

} // namespace haarlight::renderer
