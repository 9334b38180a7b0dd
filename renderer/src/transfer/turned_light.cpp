#include <renderer/transfer/turned_light.h>

#include <renderer/scene/transform.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

/// Pixels along the side of the map that turned ones are sampled from.
constexpr int side_max = 1024;

} // namespace

Eigen::Matrix3f turn_of(const Eigen::Vector3d& yaw_pitch_roll) {
  const Transform turn = rotation(Eigen::Vector3d::UnitY(), yaw_pitch_roll[0])
                             .then(rotation(Eigen::Vector3d::UnitX(), yaw_pitch_roll[1]))
                             .then(rotation(Eigen::Vector3d::UnitZ(), yaw_pitch_roll[2]));
  return turn.linear.cast<float>();
}

TurnedLight::TurnedLight(const Light& light, int resolution)
    : m_resolution(resolution), m_level(probe::make_rotatable(light.map(
                                    std::max(std::min(4 * resolution, side_max), resolution)))) {
  for (int axis = 0; axis < 3; ++axis)
    m_placed.col(axis) = light.to_world(Vec3::Unit(axis));
}

wavelet::Map TurnedLight::map(const Eigen::Matrix3f& turn) const {
  const Eigen::Matrix3f back = m_placed.transpose() * turn.transpose() * m_placed;
  return probe::rotate_map(m_level, {back.col(0), back.col(1), back.col(2)}, m_resolution);
}

} // namespace haarlight::renderer
