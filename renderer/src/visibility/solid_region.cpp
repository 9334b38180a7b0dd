#include "visibility/solid_region.h"

#include "shapes/shape_canonical.h"

#include <wavelet/base/elementary.h>

#include <algorithm>
#include <array>
#include <cmath>

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

/// What a map stretches vectors by at most; exact if it stretches all alike.
double stretch_bound(const Eigen::Matrix3d& linear) {
  return std::sqrt((linear.transpose() * linear).cwiseAbs().rowwise().sum().maxCoeff());
}

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
  if (solid.kind == SolidKind::Torus)
    find_tube(origin);
}

/// So that what is seen through the ring is told apart from it.
void SolidRays::find_tube(const Eigen::Vector3d& origin) {
  constexpr int balls = 48;
  constexpr double half_step = 180.0 / balls;
  // A ball reaches from its centre to the tube's surface half a step along the ring.
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
  const auto is_beside = [&](const Cap& bounds) {
    return bounds.classify(cap) == RegionPart::Outside;
  };
  if (is_beside(m_bounds) || (!m_tube.empty() && std::ranges::all_of(m_tube, is_beside)))
    return true;
  const Vec3 aside = m_bounds.axis - m_bounds.axis.dot(cap.centre) * cap.centre;
  const float distance = aside.norm();
  if (cap.cosine < least_cosine || distance < 1e-6F)
    return false;
  const Vec3 t = aside / distance;
  const Vec3 b = cap.centre.cross(t);
  Vec2 best = Vec2::UnitX();
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
    const Vec2 side = turn * Vec2(-best.y(), best.x());
    const Vec2 left = (best + side).normalized();
    const Vec2 right = (best - side).normalized();
    if (try_way(left) || try_way(right))
      return true;
  }
  return false;
}

bool SolidRays::all_meet(const SquareCap& cap) const {
  if (m_solid.kind == SolidKind::Torus) // which is not convex
    return std::ranges::any_of(
        m_core, [&](const Cap& core) { return core.classify(cap) == RegionPart::Inside; });
  if (cap.cosine < least_cosine)
    return false;
  const Frame frame = frame_about(cap.centre);
  const float reach = cap.sine / cap.cosine;
  return std::ranges::all_of(corners, [&](const auto& corner) {
    return meet(frame.n + reach * (corner[0] * frame.t + corner[1] * frame.b));
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
