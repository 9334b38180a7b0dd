#include "visibility/conservative_visibility.h"
#include "shapes/solid.h"
#include "visibility/ray_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

namespace haarlight::renderer::detail {
namespace {

using wavelet::RegionPart;
using wavelet::Square;
using wavelet::SquareCap;
using wavelet::SquareView;

/// Whether the face of a box at the low or high end of an axis is visible from a point.
bool sees_face(const Bounds& box, const Eigen::Vector3d& from, int axis, bool high) {
  return high ? from[axis] > box.high[axis] : from[axis] < box.low[axis];
}

/// An edge of a box along an axis, at the low or high end of the other two axes.
struct Edge {
  int axis = 0;
  bool high1 = false;
  bool high2 = false;

  int axis1() const { return (axis + 1) % 3; }
  int axis2() const { return (axis + 2) % 3; }

  bool is_silhouette(const Bounds& box, const Eigen::Vector3d& from) const {
    return sees_face(box, from, axis1(), high1) != sees_face(box, from, axis2(), high2);
  }

  Eigen::Vector3d end(const Bounds& box, bool high) const {
    Eigen::Vector3d p;
    p[axis] = (high ? box.high : box.low)[axis];
    p[axis1()] = (high1 ? box.high : box.low)[axis1()];
    p[axis2()] = (high2 ? box.high : box.low)[axis2()];
    return p;
  }
};

/// Of a solid's bounding box; without planes from inside the box.
/// @param origin of the directions, in the world
/// @param to_frame rotation from the world to the frame of the directions
Outline outline_of(const Solid& solid, const Eigen::Vector3d& origin,
                   const Eigen::Matrix3f& to_frame) {
  const Bounds box = canonical_bounds(solid);
  const Eigen::Vector3d from = solid.to_object.point(origin);
  const auto seen = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return solid.to_world.point(p) - origin;
  };
  const Eigen::Vector3d middle = seen((box.low + box.high) / 2);
  Outline outline;
  int count = 0;
  for (int i = 0; i < 12; ++i) {
    const Edge edge = {i / 4, i % 2 != 0, i / 2 % 2 != 0};
    if (!edge.is_silhouette(box, from))
      continue;
    const Eigen::Vector3d across = seen(edge.end(box, false)).cross(seen(edge.end(box, true)));
    const Vec3 normal = to_frame * across.normalized().cast<float>();
    for (int lane = count++; lane < 8; ++lane)
      outline.set(lane, across.dot(middle) < 0 ? Vec3(-normal) : normal);
  }
  return outline;
}

/// Visible fraction of a square none of whose points is visible.
constexpr float min_visible = 1.0F / 64;

/// Of SquareView::occluders: represents all obstacles from this index on.
constexpr std::size_t last_bit = 63;

/// The tested points of a square, one in each of eight columns and rows. None lies on an edge,
/// where the horizon of a horizontal plane coincides with a whole row of squares.
constexpr std::size_t batches = 2;
constexpr unsigned all_points = 0xFF;
using Points = std::array<Lanes3, batches>;

Points points_of(const Square& square) {
  constexpr Float4 columns[batches] = {{0.5F, 1.5F, 2.5F, 3.5F}, {4.5F, 5.5F, 6.5F, 7.5F}};
  constexpr Float4 rows[batches] = {{1.5F, 4.5F, 7.5F, 2.5F}, {5.5F, 0.5F, 3.5F, 6.5F}};
  const float step = power_of_two(-square.level - 3);
  const float u = static_cast<float>(8 * square.column);
  const float v = static_cast<float>(8 * square.row);
  Points points;
  for (std::size_t i = 0; i < batches; ++i)
    wavelet::square_to_sphere((u + columns[i]) * step, (v + rows[i]) * step, points[i].x,
                              points[i].y, points[i].z);
  return points;
}

unsigned lane_bits(Int4 lanes) {
  const Int4 four = lanes & Int4{1, 2, 4, 8};
  return static_cast<unsigned>(four[0] | four[1] | four[2] | four[3]);
}

/// Bits of the points whose dot product with a normal exceeds `least`.
unsigned points_beyond(const Points& points, const Vec3& normal, float least) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < batches; ++i) {
    const Lanes3& p = points[i];
    const Int4 beyond =
        p.x * normal.x() + p.y * normal.y() + p.z * normal.z() > broadcast<Float4>(least);
    bits |= lane_bits(beyond) << (4 * i);
  }
  return bits;
}

/// Bits of the points that a solid occludes.
unsigned points_behind(const Points& points, const Obstacle& obstacle) {
  const Eigen::Matrix3f& m = obstacle.to_object;
  unsigned bits = 0;
  for (std::size_t i = 0; i < batches; ++i) {
    const auto along = [&](int axis) {
      return m(axis, 0) * points[i].x + m(axis, 1) * points[i].y + m(axis, 2) * points[i].z;
    };
    const Lanes3 directions = {along(0), along(1), along(2)};
    bits |= lane_bits(rays_hit(*obstacle.solid, obstacle.origin, directions)) << (4 * i);
  }
  return bits;
}

/// The visible points of a square above the horizon. Points are computed once an occluder may
/// affect the square.
class VisibilityQuery {
public:
  VisibilityQuery(const Square& square, const Vec3& normal)
      : m_square(square), m_cap(wavelet::square_cap(square)), m_normal(normal) {}

  /// Removes the points that an obstacle occludes.
  /// @return the square's position relative to the occluded region; Partial if unknown
  RegionPart remove_behind(const Obstacle& obstacle) {
    const RegionPart part = obstacle.bounds.classify(m_cap);
    if (part == RegionPart::Outside)
      return part;
    if (obstacle.solid != nullptr)
      return remove_behind_solid(obstacle);
    if (part == RegionPart::Partial)
      remove(points_beyond(points(), obstacle.bounds.axis, obstacle.bounds.cosine));
    return part;
  }

  /// Of the part above the horizon.
  float visible_fraction() const {
    if (!m_points || m_visible == m_above)
      return 1;
    return std::max(min_visible, static_cast<float>(std::popcount(m_visible)) /
                                     static_cast<float>(std::popcount(m_above)));
  }

private:
  RegionPart remove_behind_solid(const Obstacle& obstacle) {
    const RegionPart part = obstacle.outline.classify(m_cap);
    if (part == RegionPart::Outside)
      return part;
    if (part == RegionPart::Inside && obstacle.solid->kind == SolidKind::Box)
      return part;
    remove(points_behind(points(), obstacle));
    return RegionPart::Partial;
  }

  void remove(unsigned points) { m_visible &= ~points; }

  const Points& points() {
    if (!m_points) {
      m_points = points_of(m_square);
      m_above = points_beyond(*m_points, m_normal, 0);
      m_visible = m_above;
    }
    return *m_points;
  }

  Square m_square;
  SquareCap m_cap;
  Vec3 m_normal;
  std::optional<Points> m_points;
  unsigned m_above = all_points;
  unsigned m_visible = all_points;
};

} // namespace

ConservativeVisibility::ConservativeVisibility(const ShapeSet& shapes, const Light& light)
    : m_shapes(shapes), m_light(light), m_visibility(shapes, light) {}

void ConservativeVisibility::set_shading_point(const Hit& from) {
  m_obstacles.clear();
  m_normal = m_light.to_light(from.normal);
  const Eigen::Vector3d origin = leave(from, from.normal).origin.cast<double>();
  for (const WorldPlane& plane : m_shapes.planes()) {
    if (!m_visibility.may_hide(plane.object, from))
      continue;
    const bool above = plane.normal.dot(origin) > plane.height;
    const Vec3 normal = m_light.to_light(plane.normal.cast<float>());
    m_obstacles.emplace_back().bounds = Cap::half_space(above ? Vec3(-normal) : normal);
  }
  for (const Solid& solid : m_shapes.solids())
    if (m_visibility.may_hide(solid.object, from))
      add(solid, origin);
}

void ConservativeVisibility::add(const Solid& solid, const Eigen::Vector3d& origin) {
  Obstacle& added = m_obstacles.emplace_back();
  added.bounds = Cap::around_ball(solid.center - origin, solid.radius);
  added.bounds.axis = m_light.to_light(added.bounds.axis);
  if (solid.kind == SolidKind::WorldSphere)
    return;
  added.solid = &solid;
  Eigen::Matrix3f to_light;
  for (int i = 0; i < 3; ++i)
    to_light.col(i) = m_light.to_light(Vec3::Unit(i));
  added.outline = outline_of(solid, origin, to_light);
  added.origin = solid.to_object.point(origin).cast<float>();
  for (int i = 0; i < 3; ++i)
    added.to_object.col(i) =
        solid.to_object.vector(m_light.to_world(Vec3::Unit(i)).cast<double>()).cast<float>();
}

void ConservativeVisibility::query_visibility(std::span<const Square> squares,
                                              std::span<SquareView> views) {
  for (std::size_t i = 0; i < squares.size(); ++i)
    views[i] = view_of(squares[i], views[i].occluders);
}

SquareView ConservativeVisibility::view_of(const Square& square, std::uint64_t occluders) const {
  VisibilityQuery query(square, m_normal);
  std::uint64_t in_part = 0;
  for (std::uint64_t rest = occluders; rest != 0; rest &= rest - 1) {
    const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
    const std::size_t end = bit == last_bit ? m_obstacles.size() : bit + 1;
    for (std::size_t i = bit; i < std::min(end, m_obstacles.size()); ++i)
      switch (query.remove_behind(m_obstacles[i])) {
      case RegionPart::Inside:
        return {0, 0};
      case RegionPart::Partial:
        in_part |= std::uint64_t{1} << bit;
        break;
      case RegionPart::Outside:
        break;
      }
  }
  return {query.visible_fraction(), in_part};
}

} // namespace haarlight::renderer::detail
