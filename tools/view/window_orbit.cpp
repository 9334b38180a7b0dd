#include <view/window_orbit.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace haarlight::view {

using renderer::CameraDescription;

namespace {

constexpr double degree = std::numbers::pi / 180;

} // namespace

Orbit::Orbit(const CameraDescription& start) : m_start(start) {
  const Eigen::Vector3d offset = (start.from - start.to).cast<double>();
  m_distance = offset.norm();
  m_above = std::asin(offset.dot(start.up.cast<double>().normalized()) / m_distance) / degree;
}

void Orbit::turn(double right, double up) {
  m_right = std::remainder(m_right + right, 360);
  m_above = std::clamp(m_above + up, -89.0, 89.0);
}

void Orbit::enlarge(double factor) { m_scale = std::clamp(m_scale / factor, 1e-3, 1e3); }

CameraDescription Orbit::camera() const {
  const Eigen::Vector3d up = m_start.up.cast<double>().normalized();
  const Eigen::Vector3d offset = (m_start.from - m_start.to).cast<double>();
  const Eigen::Vector3d ahead = (offset - offset.dot(up) * up).normalized();
  const Eigen::Vector3d across = up.cross(ahead);
  const double right = m_right * degree;
  const double above = m_above * degree;
  const Eigen::Vector3d direction =
      std::cos(above) * (std::cos(right) * ahead + std::sin(right) * across) + std::sin(above) * up;
  CameraDescription camera = m_start;
  const bool parallel = camera.projection == renderer::CameraProjection::Orthographic;
  camera.height *= parallel ? m_scale : 1;
  const double distance = m_distance * (parallel ? 1 : m_scale);
  camera.from = m_start.to + (distance * direction).cast<float>();
  return camera;
}

} // namespace haarlight::view
