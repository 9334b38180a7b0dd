#include <view/controls.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace haarlight::view {

using renderer::CameraDescription;

namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;
constexpr float interactive_tolerance = 0.05F; ///< lower bound while something moves

// Time limits of a frame, milliseconds.
constexpr double moving_limit = 60;
constexpr double still_limit = 3000;

float rotated_angle(float angle, double pixels) {
  return angle + static_cast<float>(degrees_per_pixel * pixels);
}

} // namespace

OrbitCamera::OrbitCamera(const CameraDescription& start) : m_start(start) {
  const Eigen::Vector3d offset = (start.from - start.to).cast<double>();
  m_distance = offset.norm();
  m_elevation =
      std::asin(offset.dot(start.up.cast<double>().normalized()) / m_distance) / radians_per_degree;
}

void OrbitCamera::orbit(double right, double up) {
  m_azimuth = std::remainder(m_azimuth + right, 360);
  m_elevation = std::clamp(m_elevation + up, -89.0, 89.0);
}

void OrbitCamera::zoom(double factor) { m_scale = std::clamp(m_scale / factor, 1e-3, 1e3); }

CameraDescription OrbitCamera::camera() const {
  const Eigen::Vector3d up = m_start.up.cast<double>().normalized();
  const Eigen::Vector3d offset = (m_start.from - m_start.to).cast<double>();
  const Eigen::Vector3d ahead = (offset - offset.dot(up) * up).normalized();
  const Eigen::Vector3d across = up.cross(ahead);
  const double azimuth = m_azimuth * radians_per_degree;
  const double elevation = m_elevation * radians_per_degree;
  const Eigen::Vector3d direction =
      std::cos(elevation) * (std::cos(azimuth) * ahead + std::sin(azimuth) * across) +
      std::sin(elevation) * up;
  CameraDescription camera = m_start;
  const bool orthographic = camera.projection == renderer::CameraProjection::Orthographic;
  camera.height *= orthographic ? m_scale : 1;
  const double distance = m_distance * (orthographic ? 1 : m_scale);
  camera.from = m_start.to + (distance * direction).cast<float>();
  return camera;
}

void ResolutionController::update(bool moving, double full_time, int min_size) {
  if (m_fixed)
    return;
  // The time of a picture with the interactive tolerance does not predict that of a still picture.
  const bool moved = std::exchange(m_moving, moving);
  const int finer = (m_pixel_size + 1) / 2;
  if (moving)
    m_pixel_size = static_cast<int>(
        std::ceil(std::clamp(std::sqrt(full_time / moving_limit), 1.0, 1.0 * largest_pixel_size)));
  else if (!moved && full_time <= still_limit * finer * finer)
    m_pixel_size = finer;
  m_pixel_size = std::max(m_pixel_size, min_size);
}

void apply_input(const UserInput& input, const CameraDescription& start, OrbitCamera& orbit,
                 Settings& settings) {
  if (input.reset) {
    orbit = OrbitCamera(start);
    settings.light_yaw = settings.light_pitch = 0;
  }
  orbit.orbit(-degrees_per_pixel * input.orbit_x, degrees_per_pixel * input.orbit_y);
  orbit.zoom(std::pow(1.1, input.wheel));
  settings.light_yaw = std::remainder(rotated_angle(settings.light_yaw, input.light_x), 360.0F);
  settings.light_pitch =
      std::clamp(rotated_angle(settings.light_pitch, input.light_y), -90.0F, 90.0F);
  settings.panel = settings.panel != input.toggle_panel;
}

ViewState view_state(const Settings& settings, const OrbitCamera& orbit,
                     const PunctualLight& punctual, bool interactive) {
  // About the world's axes, as LightDescription::rotate rotates a probe.
  constexpr float degree = std::numbers::pi_v<float> / 180;
  const Eigen::AngleAxisf yaw(settings.light_yaw * degree, Vec3::UnitY());
  const Eigen::AngleAxisf pitch(settings.light_pitch * degree, Vec3::UnitX());
  ViewState state;
  state.camera = orbit.camera();
  state.to_world = (yaw * pitch).toRotationMatrix();
  state.punctual = punctual;
  state.punctual.place = state.to_world * punctual.place;
  state.tolerance = std::max(settings.tolerance, interactive ? interactive_tolerance : 0);
  state.level = settings.level;
  return state;
}

} // namespace haarlight::view
