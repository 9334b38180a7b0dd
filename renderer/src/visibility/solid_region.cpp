#include "solid_region.h"

#include "../shape_canonical.h"

#include <cmath>

namespace haarlight::renderer::detail {

using wavelet::RegionPart;
using wavelet::SquareCap;
using wavelet::SquarePlace;

namespace {

/// Half the width, at distance 1, of a square pyramid around a cap; wide caps have none.
float pyramid_reach(const SquareCap& cap) { return cap.sine / cap.cosine; }
bool has_pyramid(const SquareCap& cap) { return cap.cosine > 0.5F; }

constexpr std::array<std::array<float, 2>, 4> sides = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
constexpr std::array<std::array<float, 2>, 4> corners = {{{1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

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
    : m_light(light), m_solid(solid), m_to_shape(solid.to_world.offset - origin),
      m_object_origin(solid.to_object.point(origin)) {}

bool SolidRays::meet(const Vec3& direction) const {
  const Eigen::Vector3d w = m_light.to_world(direction).cast<double>();
  return canonical_distance(m_solid, m_object_origin, m_solid.to_object.vector(w)) < no_hit;
}

bool SolidRays::behind(const Vec3& normal) const {
  const Eigen::Vector3d n = m_light.to_world(normal).cast<double>();
  return n.dot(m_to_shape) + canonical_support(m_solid, m_solid.to_world.linear.transpose() * n) <
         0;
}

bool SolidRays::all_miss(const SquareCap& cap) const {
  if (!has_pyramid(cap))
    return false;
  const Frame frame = frame_about(cap.centre);
  const float reach = pyramid_reach(cap);
  for (const auto& [along_t, along_b] : sides)
    if (behind(reach * frame.n - along_t * frame.t - along_b * frame.b))
      return true;
  return false;
}

bool SolidRays::all_meet(const SquareCap& cap) const {
  if (!has_pyramid(cap) || m_solid.kind == SolidKind::Torus) // which is not convex
    return false;
  const Frame frame = frame_about(cap.centre);
  const float reach = pyramid_reach(cap);
  for (const auto& [along_t, along_b] : corners)
    if (!meet(frame.n + reach * (along_t * frame.t + along_b * frame.b)))
      return false;
  return true;
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
