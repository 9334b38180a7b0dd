#include <renderer/visibility/visibility.h>

#include "visibility/horizon_region.h"
#include "visibility/solid_region.h"

#include <cassert>

namespace haarlight::renderer {

using namespace detail;
using wavelet::RegionTreeBuilder;
using wavelet::Tree;

namespace detail {

/// A shape of the set: one of the two.
struct Occluder {
  const Solid* solid = nullptr;
  const WorldPlane* plane = nullptr;
};

} // namespace detail

namespace {

/// Where rays to the side that is seen start.
Eigen::Vector3d origin_of(const Hit& from) {
  return leave(from, from.normal).origin.cast<double>();
}

/// What lies on the same side of the plane as the origin.
CapRegion beside_plane(const WorldPlane& plane, const Eigen::Vector3d& origin, const Light& light) {
  const double above = plane.normal.dot(origin) - plane.height;
  const Vec3 normal = light.to_light(plane.normal.cast<float>());
  return {Cap::half_space(above < 0 ? Vec3(-normal) : normal), false};
}

CapRegion around_sphere(const Solid& sphere, const Eigen::Vector3d& origin, const Light& light) {
  Cap cap = Cap::around_ball(sphere.center - origin, sphere.radius);
  cap.axis = light.to_light(cap.axis);
  return {cap, true};
}

} // namespace

VisibilityTrees::VisibilityTrees(const ShapeSet& shapes, const Light& light)
    : m_light(light), m_occluders(static_cast<std::size_t>(shapes.size())) {
  for (const Solid& solid : shapes.solids())
    m_occluders[static_cast<std::size_t>(solid.object)].solid = &solid;
  for (const WorldPlane& plane : shapes.planes())
    m_occluders[static_cast<std::size_t>(plane.object)].plane = &plane;
}

VisibilityTrees::~VisibilityTrees() = default;

void VisibilityTrees::object(int object, const Hit& from, int levels, RegionTreeBuilder& builder,
                             Tree& out) const {
  assert(object != from.object);
  const Occluder& occluder = m_occluders[static_cast<std::size_t>(object)];
  const Eigen::Vector3d origin = origin_of(from);
  if (occluder.plane != nullptr)
    builder.build(beside_plane(*occluder.plane, origin, m_light), levels, out);
  else if (occluder.solid->kind == SolidKind::WorldSphere)
    builder.build(around_sphere(*occluder.solid, origin, m_light), levels, out);
  else
    builder.build(SolidRegion(*occluder.solid, origin, m_light), levels, out);
}

bool VisibilityTrees::shadows_itself(int object) const {
  const Solid* solid = m_occluders[static_cast<std::size_t>(object)].solid;
  return solid != nullptr && solid->kind == SolidKind::Torus;
}

bool VisibilityTrees::may_hide(int object, const Hit& from) const {
  if (object == from.object)
    return shadows_itself(object);
  const Solid* solid = m_occluders[static_cast<std::size_t>(object)].solid;
  return solid == nullptr ||
         from.normal.cast<double>().dot(solid->center - origin_of(from)) > -solid->radius;
}

void VisibilityTrees::own(const Hit& from, int levels, bool cosine, RegionTreeBuilder& builder,
                          Tree& out) const {
  std::optional<SolidRays> rays;
  if (shadows_itself(from.object))
    rays.emplace(*m_occluders[static_cast<std::size_t>(from.object)].solid, origin_of(from),
                 m_light);
  builder.build(HorizonRegion(m_light.to_light(from.normal), rays, cosine), levels, out);
}

Tree VisibilityTrees::object(int object, const Hit& from, int levels) const {
  RegionTreeBuilder builder;
  Tree tree;
  this->object(object, from, levels, builder, tree);
  return tree;
}

Tree VisibilityTrees::own(const Hit& from, int levels) const {
  RegionTreeBuilder builder;
  Tree tree;
  own(from, levels, builder, tree);
  return tree;
}

Tree VisibilityTrees::local(const Hit& from, int levels) const {
  RegionTreeBuilder builder;
  Tree tree;
  own(from, levels, true, builder, tree);
  return tree;
}

} // namespace haarlight::renderer
