#include <renderer/visibility/visibility.h>

#include "shapes/solid.h"
#include "visibility/cap.h"

#include <renderer/light/light.h>
#include <renderer/shapes/shapes.h>

#include <wavelet/base/elementary.h>
#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace haarlight::renderer {

namespace detail {

/// An object: either a solid or a plane.
struct Occluder {
  const Solid* solid = nullptr;
  const WorldPlane* plane = nullptr;
};

} // namespace detail

namespace {

using namespace detail;
using wavelet::RegionPart;
using wavelet::RegionTreeBuilder;
using wavelet::Square;
using wavelet::SquareCap;
using wavelet::Tree;

/// 1 within a cap and 0 outside, or the reverse.
class CapRegion final : public wavelet::Region {
public:
  CapRegion(const Cap& cap, bool reverse) : m_cap(cap), m_reverse(reverse) {}

  RegionPart classify(const Square& square) const override {
    const RegionPart part = m_cap.classify(wavelet::square_cap(square));
    if (part == RegionPart::Partial)
      return part;
    return (part == RegionPart::Inside) != m_reverse ? RegionPart::Inside : RegionPart::Outside;
  }

  float coverage(const Square& square) const override {
    const Vec3& a = m_cap.axis;
    const float inside = wavelet::positive_fraction_of(square, [&](Float4 x, Float4 y, Float4 z) {
      const Float4 dx = x - a.x();
      const Float4 dy = y - a.y();
      const Float4 dz = z - a.z();
      return m_cap.chord_squared - (dx * dx + dy * dy + dz * dz);
    });
    return m_reverse ? 1 - inside : inside;
  }

private:
  Cap m_cap;
  bool m_reverse;
};

/// Number of ray directions of a square.
constexpr std::size_t net_size = 16;

/// Points of a square, a (0, 2)-net of 16 points (Sobol'); the first 4 are a net, too.
Vec2 net_point(const Square& square, std::size_t index) {
  static constexpr std::array<std::uint8_t, net_size> columns = {0, 8, 4, 12, 2, 10, 6, 14,
                                                                 1, 9, 5, 13, 3, 11, 7, 15};
  static constexpr std::array<std::uint8_t, net_size> rows = {0,  8, 12, 4,  10, 2,  6, 14,
                                                              15, 7, 3,  11, 5,  13, 9, 1};
  const float side = power_of_two(-square.level);
  const auto at = [&](std::uint32_t corner, std::uint8_t step) {
    return (static_cast<float>(corner) + (static_cast<float>(step) + 0.5F) / net_size) * side;
  };
  return {at(square.column, columns[index]), at(square.row, rows[index])};
}

/// Upper bound on the factor by which a map scales vectors; exact for similarities.
double stretch_bound(const Eigen::Matrix3d& linear) {
  return std::sqrt((linear.transpose() * linear).cwiseAbs().rowwise().sum().maxCoeff());
}

/// Rays from one point against one shape; directions in the light's frame.
class SolidRays {
public:
  /// @param light must outlive this, and so must the solid
  SolidRays(const Solid& solid, const Eigen::Vector3d& origin, const Light& light)
      : m_light(light), m_solid(solid),
        m_bounds(Cap::around_ball(solid.center - origin, solid.radius)),
        m_to_shape(solid.to_world.offset - origin), m_object_origin(solid.to_object.point(origin)) {
    m_bounds.axis = light.to_light((solid.center - origin).normalized().cast<float>());
    if (solid.kind == SolidKind::Torus)
      cover_torus(origin);
  }

  bool intersects(const Vec3& direction) const {
    const Eigen::Vector3d d = m_solid.to_object.vector(m_light.to_world(direction).cast<double>());
    return canonical_distance(m_solid, m_object_origin, d) < no_hit;
  }

  /// Whether no ray within a cap hits the shape; conservative: may return false. Searches for a
  /// plane through the origin that separates the cap from the shape.
  bool all_miss(const SquareCap& cap) const {
    // Directions about the cap's axis; the first is that of the shape's centre.
    constexpr std::array<std::array<float, 2>, 5> directions = {
        {{1, 0}, {0.7071F, 0.7071F}, {0.7071F, -0.7071F}, {0.3827F, 0.9239F}, {0.3827F, -0.9239F}}};
    // Successive rotations of the best of them to either side.
    constexpr std::array<float, 5> rotations = {0.4F, 0.2F, 0.1F, 0.05F, 0.025F};
    const auto is_outside = [&](const Cap& bounds) {
      return bounds.classify(cap) == RegionPart::Outside;
    };
    if (is_outside(m_bounds) || (!m_tube.empty() && std::ranges::all_of(m_tube, is_outside)))
      return true;
    const Vec3 aside = m_bounds.axis - m_bounds.axis.dot(cap.centre) * cap.centre;
    const float distance = aside.norm();
    if (cap.cosine < min_cosine || distance < 1e-6F)
      return false;
    const Vec3 t = aside / distance;
    const Vec3 b = cap.centre.cross(t);
    Vec2 best = Vec2::UnitX();
    double most = -no_hit;
    const auto separates = [&](const Vec2& w) {
      const double found = clearance(cap.cosine * (w.x() * t + w.y() * b) - cap.sine * cap.centre);
      if (found > most) {
        most = found;
        best = w;
      }
      return most > 0;
    };
    for (const auto& w : directions)
      if (separates({w[0], w[1]}))
        return true;
    for (const float rotation : rotations) {
      const Vec2 side = rotation * Vec2(-best.y(), best.x());
      const Vec2 left = (best + side).normalized();
      const Vec2 right = (best - side).normalized();
      if (separates(left) || separates(right))
        return true;
    }
    return false;
  }

  /// Whether all rays within a cap hit the shape; conservative: may return false. Tests the corners
  /// of the cap's bounding pyramid.
  bool all_hit(const SquareCap& cap) const {
    constexpr std::array<std::array<float, 2>, 4> corners = {{{1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
    if (m_solid.kind == SolidKind::Torus) // not convex
      return std::ranges::any_of(
          m_core, [&](const Cap& core) { return core.classify(cap) == RegionPart::Inside; });
    if (cap.cosine < min_cosine)
      return false;
    const Frame frame = frame_about(cap.centre);
    const float reach = cap.sine / cap.cosine;
    return std::ranges::all_of(corners, [&](const auto& corner) {
      return intersects(frame.n + reach * (corner[0] * frame.t + corner[1] * frame.b));
    });
  }

private:
  static constexpr float min_cosine = 0.5F; ///< of caps that are tested by pyramids

  /// Least distance of the shape beyond a plane through the rays' origin, on the side of its unit
  /// normal; negative if the plane does not separate them.
  double clearance(const Vec3& normal) const {
    const Eigen::Vector3d n = m_light.to_world(normal).cast<double>();
    return n.dot(m_to_shape) -
           canonical_support(m_solid, -(m_solid.to_world.linear.transpose() * n));
  }

  /// Covers the tube by balls, so that directions through the ring are classified as unoccluded.
  void cover_torus(const Eigen::Vector3d& origin) {
    constexpr int balls = 48;
    constexpr double half_step = 180.0 / balls;
    // A ball must contain the tube's surface up to half a step along the ring.
    const double along = 2 * (1 + m_solid.tube) * sine_cosine_degrees(half_step / 2).sine;
    const double outer = std::hypot(m_solid.tube, along) * stretch_bound(m_solid.to_world.linear);
    const double inner = m_solid.tube / stretch_bound(m_solid.to_object.linear);
    for (int i = 0; i < balls; ++i) {
      const SineCosine angle = sine_cosine_degrees(2 * half_step * i);
      const Eigen::Vector3d middle = m_solid.to_world.point({angle.cosine, angle.sine, 0}) - origin;
      const Vec3 axis = m_light.to_light(middle.normalized().cast<float>());
      m_tube.push_back(Cap::around_ball(middle, outer));
      m_tube.back().axis = axis;
      m_core.push_back(Cap::around_ball(middle, inner));
      m_core.back().axis = axis;
    }
  }

  const Light& m_light;
  const Solid& m_solid;
  Cap m_bounds;                    ///< of the shape's bounding sphere
  std::vector<Cap> m_tube;         ///< of a torus: of balls that cover its tube …
  std::vector<Cap> m_core;         ///< … and of balls inside its tube
  Eigen::Vector3d m_to_shape;      ///< from the origin to the shape's own origin
  Eigen::Vector3d m_object_origin; ///< of the rays, in the shape's frame
};

/// 1 in directions whose rays miss a shape.
class SolidRegion final : public wavelet::Region {
public:
  SolidRegion(const Solid& solid, const Eigen::Vector3d& origin, const Light& light)
      : m_rays(solid, origin, light) {}

  RegionPart classify(const Square& square) const override {
    const SquareCap cap = wavelet::square_cap(square);
    if (m_rays.all_miss(cap))
      return RegionPart::Inside;
    return m_rays.all_hit(cap) ? RegionPart::Outside : RegionPart::Partial;
  }

  float coverage(const Square& square) const override {
    int missed = 0;
    for (std::size_t i = 0; i < net_size; ++i)
      missed += m_rays.intersects(wavelet::square_to_sphere(net_point(square, i))) ? 0 : 1;
    return static_cast<float>(missed) / net_size;
  }

private:
  SolidRays m_rays;
};

/// Self-occlusion: 0 below the horizon of a hit and where the shape that it lies on occludes
/// itself, 1 elsewhere.
class HorizonRegion final : public wavelet::Region {
public:
  /// @param normal in the light's frame
  /// @param own    the shape, if it is not convex
  HorizonRegion(const Vec3& normal, const std::optional<SolidRays>& own)
      : m_normal(normal), m_horizon(Cap::half_space(normal), false), m_own(own) {}

  RegionPart classify(const Square& square) const override {
    const RegionPart part = m_horizon.classify(square);
    return part == RegionPart::Inside && m_own ? RegionPart::Partial : part;
  }

  float coverage(const Square& square) const override {
    const float above = m_horizon.coverage(square);
    return m_own && above > 0 ? above * unoccluded_fraction(square) : above;
  }

private:
  /// Of the part of a square above the horizon; takes more rays where the first few disagree.
  float unoccluded_fraction(const Square& square) const {
    constexpr std::size_t few = 4;
    float all = 0;
    float missed = 0;
    for (std::size_t i = 0; i < net_size; ++i) {
      if (i == few && all > 0 && (missed == 0 || missed == all))
        break;
      const Vec3 w = wavelet::square_to_sphere(net_point(square, i));
      if (!(m_normal.dot(w) > 0))
        continue;
      ++all;
      missed += m_own->intersects(w) ? 0.0F : 1.0F;
    }
    return all > 0 ? missed / all : 1;
  }

  Vec3 m_normal;
  CapRegion m_horizon;
  std::optional<SolidRays> m_own;
};

/// Origin of rays to the viewer's side.
Eigen::Vector3d origin_of(const Hit& from) {
  return leave(from, from.normal).origin.cast<double>();
}

/// 1 in directions whose rays miss the plane.
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

using namespace detail;
using wavelet::RegionTreeBuilder;
using wavelet::Tree;

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

void VisibilityTrees::own(const Hit& from, int levels, RegionTreeBuilder& builder,
                          Tree& out) const {
  std::optional<SolidRays> rays;
  if (shadows_itself(from.object))
    rays.emplace(*m_occluders[static_cast<std::size_t>(from.object)].solid, origin_of(from),
                 m_light);
  builder.build(HorizonRegion(m_light.to_light(from.normal), rays), levels, out);
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

std::span<const wavelet::TreeView> OccluderTrees::at(const Hit& hit, int without) {
  m_views.clear();
  for (std::size_t i = 0; i < m_trees.size(); ++i) {
    const int object = static_cast<int>(i);
    if (object == without || !m_visibility.may_hide(object, hit))
      continue;
    if (object == hit.object)
      m_visibility.own(hit, m_levels, m_builder, m_trees[i]);
    else
      m_visibility.object(object, hit, m_levels, m_builder, m_trees[i]);
    if (!m_trees[i].links.empty() || (m_trees[i].mean != 1).any())
      m_views.push_back(m_trees[i].view());
  }
  return m_views;
}

} // namespace haarlight::renderer
