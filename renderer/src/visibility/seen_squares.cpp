#include "seen_squares.h"

#include "../shape_canonical.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::SquareCap;
using wavelet::SquareDirections;
using wavelet::SquarePlace;
using wavelet::SquareView;

namespace {

/// What may be seen of a square none of whose points are.
constexpr float least_seen = 1.0F / 64;

/// Of SquareView::occluders: stands for all obstacles from this number on.
constexpr std::size_t last_bit = 63;

/// The points of square_directions() as bits, and the trapezoid rule for them, in 16ths.
constexpr unsigned all_points = 0x1FF;
constexpr unsigned corner_points = 0x145;
constexpr unsigned edge_points = 0x0AA;

int points_weight(unsigned points) {
  return std::popcount(points & corner_points) + 2 * std::popcount(points & edge_points) +
         ((points >> 4U & 1U) << 2U);
}

/// Bits of those of the points that lie beyond a plane: their product with its normal is above
/// `least`.
unsigned points_beyond(const SquareDirections& at, const Vec3& normal, float least) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Int4 beyond = at.x[i] * normal.x() + at.y[i] * normal.y() + at.z[i] * normal.z() >
                        broadcast<Float4>(least);
    const Int4 four = beyond & Int4{1, 2, 4, 8};
    bits |= static_cast<unsigned>(four[0] | four[1] | four[2] | four[3]) << (4 * i);
  }
  return bits & all_points;
}

unsigned points_within(const SquareDirections& at, const Belt& belt) {
  return points_beyond(at, belt.normal, -belt.sine) & ~points_beyond(at, belt.normal, belt.sine);
}

Vec3 point_of(const SquareDirections& at, unsigned index) {
  const int lane = static_cast<int>(index % 4);
  return {at.x[index / 4][lane], at.y[index / 4][lane], at.z[index / 4][lane]};
}

/// The one that a long shape's axis and the origin span: with its axis' ends at a and b, the shape
/// lies within `radius` of what is between them.
Belt belt_around(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  const Eigen::Vector3d along = b - a;
  const Eigen::Vector3d normal = a.cross(b);
  const double t = std::clamp(-a.dot(along) / along.squaredNorm(), 0.0, 1.0);
  const double distance = (a + t * along).norm();
  if (distance <= radius || normal.norm() < 1e-9 * a.norm() * b.norm())
    return {};
  return {normal.normalized().cast<float>(), static_cast<float>(radius / (distance - radius))};
}

Belt belt_of(const Solid& solid, const Eigen::Vector3d& origin) {
  if (solid.kind == SolidKind::Torus || solid.kind == SolidKind::Disk)
    return {};
  const Eigen::Matrix3d& axes = solid.to_world.linear;
  Eigen::Index longest = 0;
  axes.colwise().squaredNorm().maxCoeff(&longest);
  const Eigen::Vector3d axis = axes.col(longest);
  const double radius = std::sqrt(std::max(0.0, axes.squaredNorm() - axis.squaredNorm()));
  const Eigen::Vector3d middle = solid.to_world.offset - origin;
  return belt_around(middle - axis, middle + axis, radius);
}

bool is_convex(const Solid& solid) { return solid.kind != SolidKind::Torus; }

/// One square, and those of its points above the horizon that nothing hides so far. The points are
/// worked out only once something may be in their way.
class Glance {
public:
  Glance(const SquarePlace& square, const Vec3& normal)
      : m_square(square), m_cap(wavelet::square_cap(square)), m_normal(normal) {}

  /// Takes away the points behind an obstacle. @return where the square surely lies of what that
  /// hides; Partial if it may be across an edge
  RegionPart look_past(const Obstacle& obstacle) {
    const RegionPart part = obstacle.bounds.classify(m_cap);
    if (part == RegionPart::Outside)
      return part;
    if (obstacle.solid != nullptr)
      return obstacle.belt.is_beside(m_cap) ? RegionPart::Outside : look_past_solid(obstacle);
    if (part == RegionPart::Partial)
      hide(points_beyond(points(), obstacle.bounds.axis, obstacle.bounds.cosine));
    return part;
  }

  /// The share of what lies above the horizon.
  float seen() const {
    if (!m_points || m_left == m_above)
      return 1;
    return std::max(least_seen, static_cast<float>(points_weight(m_left)) /
                                    static_cast<float>(points_weight(m_above)));
  }

private:
  RegionPart look_past_solid(const Obstacle& obstacle) {
    const unsigned near = points_beyond(points(), obstacle.bounds.axis, obstacle.bounds.cosine) &
                          points_within(points(), obstacle.belt);
    unsigned met = 0;
    for (unsigned rest = m_left & near; rest != 0; rest &= rest - 1) {
      const auto index = static_cast<unsigned>(std::countr_zero(rest));
      if (obstacle.meet(point_of(points(), index)))
        met |= 1U << index;
    }
    hide(met);
    return met == all_points && is_convex(*obstacle.solid) ? RegionPart::Inside
                                                           : RegionPart::Partial;
  }

  void hide(unsigned points) { m_left &= ~points; }

  const SquareDirections& points() {
    if (!m_points) {
      m_points = wavelet::square_directions(m_square);
      m_above = points_beyond(*m_points, m_normal, 0);
      m_left = m_above;
    }
    return *m_points;
  }

  SquarePlace m_square;
  SquareCap m_cap;
  Vec3 m_normal;
  std::optional<SquareDirections> m_points;
  unsigned m_above = all_points;
  unsigned m_left = all_points;
};

} // namespace

bool Obstacle::meet(const Vec3& w) const {
  return canonical_distance(*solid, origin, to_object * w.cast<double>()) < no_hit;
}

SeenSquares::SeenSquares(const ShapeSet& shapes, const Light& light)
    : m_shapes(shapes), m_light(light), m_visibility(shapes, light) {}

void SeenSquares::turn_to(const Hit& from) {
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
  added.belt = belt_of(solid, origin);
  added.belt.normal = m_light.to_light(added.belt.normal);
  added.origin = solid.to_object.point(origin);
  for (int i = 0; i < 3; ++i)
    added.to_object.col(i) = solid.to_object.vector(m_light.to_world(Vec3::Unit(i)).cast<double>());
}

void SeenSquares::look(std::span<const SquarePlace> squares, std::span<SquareView> views) {
  for (std::size_t i = 0; i < squares.size(); ++i)
    views[i] = view_of(squares[i], views[i].occluders);
}

SquareView SeenSquares::view_of(const SquarePlace& square, std::uint64_t occluders) const {
  Glance glance(square, m_normal);
  std::uint64_t in_part = 0;
  for (std::uint64_t rest = occluders; rest != 0; rest &= rest - 1) {
    const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
    const std::size_t end = bit == last_bit ? m_obstacles.size() : bit + 1;
    for (std::size_t i = bit; i < std::min(end, m_obstacles.size()); ++i)
      switch (glance.look_past(m_obstacles[i])) {
      case RegionPart::Inside:
        return {0, 0};
      case RegionPart::Partial:
        in_part |= std::uint64_t{1} << bit;
        break;
      case RegionPart::Outside:
        break;
      }
  }
  return {glance.seen(), in_part};
}

} // namespace haarlight::renderer::detail
