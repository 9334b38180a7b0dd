#include "solid_region.h"

#include "../shape_canonical.h"

#include <algorithm>
#include <array>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::SquareCap;
using wavelet::SquarePlace;

namespace {

/// Wide caps have no pyramid around them.
constexpr float least_cosine = 0.5F;

constexpr std::array<std::array<float, 2>, 4> corners = {{{1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

/// Directions, as seen from the axis of a cap, in which a plane may separate it from a shape: the
/// first is that of the shape's middle.
constexpr std::array<std::array<float, 2>, 5> ways = {
    {{1, 0}, {0.7071F, 0.7071F}, {0.7071F, -0.7071F}, {0.3827F, 0.9239F}, {0.3827F, -0.9239F}}};

/// By how much the best of them is turned to either side, in turn.
constexpr std::array<float, 5> turns = {0.4F, 0.2F, 0.1F, 0.05F, 0.025F};

} // namespace

Vec2 net_point(const SquarePlace& square, std::size_t index) {
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

SolidRays::SolidRays(const Solid& solid, const Eigen::Vector3d& origin, const Light& light)
    : m_light(light), m_solid(solid),
      m_bounds(Cap::around_ball(solid.center - origin, solid.radius)),
      m_to_shape(solid.to_world.offset - origin), m_object_origin(solid.to_object.point(origin)) {
  m_bounds.axis = light.to_light((solid.center - origin).normalized().cast<float>());
}

Eigen::Vector3d SolidRays::object_direction(const Vec3& direction) const {
  return m_solid.to_object.vector(m_light.to_world(direction).cast<double>());
}

bool SolidRays::meet(const Vec3& direction) const {
  return canonical_distance(m_solid, m_object_origin, object_direction(direction)) < no_hit;
}

double SolidRays::clearance(const Vec3& normal) const {
  const Eigen::Vector3d n = m_light.to_world(normal).cast<double>();
  return n.dot(m_to_shape) - canonical_support(m_solid, -(m_solid.to_world.linear.transpose() * n));
}

bool SolidRays::all_miss(const SquareCap& cap) const {
  if (m_bounds.classify(cap) == RegionPart::Outside)
    return true;
  const Vec3 aside = m_bounds.axis - m_bounds.axis.dot(cap.centre) * cap.centre;
  const float distance = aside.norm();
  if (cap.cosine < least_cosine || distance < 1e-6F)
    return false;
  const Vec3 t = aside / distance;
  const Vec3 b = cap.centre.cross(t);
  Vec2 best;
  double most = -no_hit;
  const auto try_way = [&](const Vec2& way) {
    const double found =
        clearance(cap.cosine * (way.x() * t + way.y() * b) - cap.sine * cap.centre);
    if (found > most) {
      most = found;
      best = way;
    }
    return most > 0;
  };
  for (const auto& way : ways)
    if (try_way({way[0], way[1]}))
      return true;
  for (const float turn : turns) {
    const Vec2 middle = best;
    const Vec2 side = turn * Vec2(-middle.y(), middle.x());
    if (try_way((middle + side).normalized()) || try_way((middle - side).normalized()))
      return true;
  }
  return false;
}

template <class Meets>
bool SolidRays::corners_meet(const SquareCap& cap, const Meets& meets) const {
  const Frame frame = frame_about(cap.centre);
  const float reach = cap.sine / cap.cosine;
  return std::ranges::all_of(corners, [&](const auto& corner) {
    return meets(object_direction(frame.n + reach * (corner[0] * frame.t + corner[1] * frame.b)));
  });
}

bool SolidRays::all_meet(const SquareCap& cap) const {
  if (cap.cosine < least_cosine)
    return false;
  if (m_solid.kind == SolidKind::Torus)
    return tube_meets(cap);
  return corners_meet(cap, [&](const Eigen::Vector3d& direction) {
    return canonical_distance(m_solid, m_object_origin, direction) < no_hit;
  });
}

/// Of a torus, which is not convex: whether all rays meet a ball in it where the middle one enters.
bool SolidRays::tube_meets(const SquareCap& cap) const {
  const Eigen::Vector3d middle = object_direction(cap.centre);
  const double entry = canonical_distance(m_solid, m_object_origin, middle);
  if (!(entry < no_hit))
    return false;
  const Eigen::Vector3d p = m_object_origin + entry * middle;
  const double around = p.head<2>().norm();
  const Eigen::Vector3d to_ball =
      Eigen::Vector3d(p.x() / around, p.y() / around, 0) - m_object_origin;
  const double radius_squared = m_solid.tube * m_solid.tube;
  return corners_meet(cap, [&](const Eigen::Vector3d& direction) {
    const double along = to_ball.dot(direction) / direction.squaredNorm();
    return along > 0 && (to_ball - along * direction).squaredNorm() < radius_squared;
  });
}

RegionPart SolidRegion::classify(const SquarePlace& square) const {
  const SquareCap cap = wavelet::square_cap(square);
  if (m_rays.all_miss(cap))
    return RegionPart::Inside;
  return m_rays.all_meet(cap) ? RegionPart::Outside : RegionPart::Partial;
}

float SolidRegion::coverage(const SquarePlace& square) const {
  int missed = 0;
  for (std::size_t i = 0; i < net_size; ++i)
    missed += m_rays.meet(wavelet::square_to_sphere(net_point(square, i))) ? 0 : 1;
  return static_cast<float>(missed) / net_size;
}

} // namespace haarlight::renderer::detail
