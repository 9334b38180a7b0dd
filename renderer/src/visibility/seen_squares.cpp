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

namespace {

/// What may be seen of a square none of whose points are.
constexpr float least_seen = 1.0F / 64;

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

} // namespace

bool RaySolid::meet(const Vec3& w) const {
  return canonical_distance(*solid, origin, to_object * w.cast<double>()) < no_hit;
}

SeenSquares::SeenSquares(const ShapeSet& shapes, const Light& light)
    : m_shapes(shapes), m_light(light), m_visibility(shapes, light) {}

/// Gathers what may be in the way.
void SeenSquares::turn() {
  m_turned = true;
  m_caps.clear();
  m_solids.clear();
  m_normal = m_light.to_light(m_from->normal);
  const Eigen::Vector3d origin = leave(*m_from, m_from->normal).origin.cast<double>();
  for (const WorldPlane& plane : m_shapes.planes()) {
    if (!m_visibility.may_hide(plane.object, *m_from))
      continue;
    const bool above = plane.normal.dot(origin) > plane.height;
    const Vec3 normal = m_light.to_light(plane.normal.cast<float>());
    m_caps.push_back(Cap::half_space(above ? Vec3(-normal) : normal));
  }
  for (const Solid& solid : m_shapes.solids())
    if (m_visibility.may_hide(solid.object, *m_from))
      add(solid, origin);
}

void SeenSquares::add(const Solid& solid, const Eigen::Vector3d& origin) {
  Cap bounds = Cap::around_ball(solid.center - origin, solid.radius);
  bounds.axis = m_light.to_light(bounds.axis);
  if (solid.kind == SolidKind::WorldSphere) {
    m_caps.push_back(bounds);
    return;
  }
  RaySolid& added = m_solids.emplace_back();
  added.solid = &solid;
  added.bounds = bounds;
  added.belt = belt_of(solid, origin);
  added.belt.normal = m_light.to_light(added.belt.normal);
  added.origin = solid.to_object.point(origin);
  for (int i = 0; i < 3; ++i)
    added.to_object.col(i) = solid.to_object.vector(m_light.to_world(Vec3::Unit(i)).cast<double>());
}

void SeenSquares::find(std::span<const SquarePlace> squares, std::span<float> seen) {
  if (!m_turned)
    turn();
  for (std::size_t i = 0; i < squares.size(); ++i)
    seen[i] = seen_of(squares[i]);
}

float SeenSquares::seen_of(const SquarePlace& square) const {
  const SquareCap cap = wavelet::square_cap(square);
  std::optional<SquareDirections> points;
  unsigned above = 0;
  unsigned left = 0;
  const auto look = [&] {
    if (points)
      return;
    points = wavelet::square_directions(square);
    above = points_beyond(*points, m_normal, 0);
    left = above;
  };
  for (const Cap& hidden : m_caps) {
    const RegionPart part = hidden.classify(cap);
    if (part == RegionPart::Inside)
      return 0;
    if (part == RegionPart::Outside)
      continue;
    look();
    left &= ~points_beyond(*points, hidden.axis, hidden.cosine);
  }
  for (const RaySolid& solid : m_solids) {
    if (solid.bounds.classify(cap) == RegionPart::Outside || solid.belt.is_beside(cap))
      continue;
    look();
    unsigned met = 0;
    for (unsigned rest = left & points_beyond(*points, solid.bounds.axis, solid.bounds.cosine) &
                         points_within(*points, solid.belt);
         rest != 0; rest &= rest - 1) {
      const auto index = static_cast<unsigned>(std::countr_zero(rest));
      if (solid.meet(point_of(*points, index)))
        met |= 1U << index;
    }
    if (met == all_points && is_convex(*solid.solid))
      return 0;
    left &= ~met;
  }
  if (!points || left == above)
    return 1;
  return std::max(least_seen, static_cast<float>(points_weight(left)) /
                                  static_cast<float>(points_weight(above)));
}

} // namespace haarlight::renderer::detail
