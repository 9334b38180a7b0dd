#include "visibility/seen_squares.h"

#include "visibility/ray_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::Square;
using wavelet::SquareCap;
using wavelet::SquareView;

namespace {

/// What may be seen of a square none of whose points are.
constexpr float least_seen = 1.0F / 64;

/// Of SquareView::occluders: stands for all obstacles from this number on.
constexpr std::size_t last_bit = 63;

/// The points of a square that are looked at, one in each of eight columns and rows. None lies on
/// an edge, where level planes have their horizon on a whole row of squares.
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

/// Bits of those of the points that lie beyond a plane: their product with its normal is above
/// `least`.
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

/// Bits of those of the points that a solid hides.
unsigned points_behind(const Points& points, const Obstacle& obstacle) {
  const Eigen::Matrix3f& m = obstacle.to_object;
  unsigned bits = 0;
  for (std::size_t i = 0; i < batches; ++i) {
    const auto along = [&](int axis) {
      return m(axis, 0) * points[i].x + m(axis, 1) * points[i].y + m(axis, 2) * points[i].z;
    };
    const Lanes3 directions = {along(0), along(1), along(2)};
    bits |= lane_bits(rays_meet(*obstacle.solid, obstacle.origin, directions)) << (4 * i);
  }
  return bits;
}

/// One square, and those of its points above the horizon that nothing hides so far. The points are
/// worked out only once something may be in their way.
class VisibilityQuery {
public:
  VisibilityQuery(const Square& square, const Vec3& normal)
      : m_square(square), m_cap(wavelet::square_cap(square)), m_normal(normal) {}

  /// Takes away the points behind an obstacle. @return where the square surely lies of what that
  /// hides; Partial if it may be across an edge
  RegionPart add_obstacle(const Obstacle& obstacle) {
    const RegionPart part = obstacle.bounds.classify(m_cap);
    if (part == RegionPart::Outside)
      return part;
    if (obstacle.solid != nullptr)
      return add_obstacle_solid(obstacle);
    if (part == RegionPart::Partial)
      hide(points_beyond(points(), obstacle.bounds.axis, obstacle.bounds.cosine));
    return part;
  }

  /// The share of what lies above the horizon.
  float seen() const {
    if (!m_points || m_left == m_above)
      return 1;
    return std::max(least_seen, static_cast<float>(std::popcount(m_left)) /
                                    static_cast<float>(std::popcount(m_above)));
  }

private:
  RegionPart add_obstacle_solid(const Obstacle& obstacle) {
    const RegionPart part = obstacle.outline.classify(m_cap);
    if (part == RegionPart::Outside)
      return part;
    if (part == RegionPart::Inside && obstacle.solid->kind == SolidKind::Box)
      return part;
    hide(points_behind(points(), obstacle));
    return RegionPart::Partial;
  }

  void hide(unsigned points) { m_left &= ~points; }

  const Points& points() {
    if (!m_points) {
      m_points = points_of(m_square);
      m_above = points_beyond(*m_points, m_normal, 0);
      m_left = m_above;
    }
    return *m_points;
  }

  Square m_square;
  SquareCap m_cap;
  Vec3 m_normal;
  std::optional<Points> m_points;
  unsigned m_above = all_points;
  unsigned m_left = all_points;
};

} // namespace

SeenSquares::SeenSquares(const ShapeSet& shapes, const Light& light)
    : m_shapes(shapes), m_light(light), m_visibility(shapes, light) {}

void SeenSquares::set_shading_point(const Hit& from) {
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

void SeenSquares::add(const Solid& solid, const Eigen::Vector3d& origin) {
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

void SeenSquares::query_visibility(std::span<const Square> squares, std::span<SquareView> views) {
  for (std::size_t i = 0; i < squares.size(); ++i)
    views[i] = view_of(squares[i], views[i].occluders);
}

SquareView SeenSquares::view_of(const Square& square, std::uint64_t occluders) const {
  VisibilityQuery query(square, m_normal);
  std::uint64_t in_part = 0;
  for (std::uint64_t rest = occluders; rest != 0; rest &= rest - 1) {
    const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
    const std::size_t end = bit == last_bit ? m_obstacles.size() : bit + 1;
    for (std::size_t i = bit; i < std::min(end, m_obstacles.size()); ++i)
      switch (query.add_obstacle(m_obstacles[i])) {
      case RegionPart::Inside:
        return {0, 0};
      case RegionPart::Partial:
        in_part |= std::uint64_t{1} << bit;
        break;
      case RegionPart::Outside:
        break;
      }
  }
  return {query.seen(), in_part};
}

} // namespace haarlight::renderer::detail
