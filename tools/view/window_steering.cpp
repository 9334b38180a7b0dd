#include <view/window_steering.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace haarlight::view {

using renderer::CameraDescription;

namespace {

constexpr double degrees_per_pixel = 0.4;
constexpr float hurried_tolerance = 0.05F; ///< at least, of a light around

float moved(float angle, double pixels) {
  return angle + static_cast<float>(degrees_per_pixel * pixels);
}

/// About the world's axes, as LightDescription::rotate turns a probe.
Eigen::Matrix3f rotation_of(const Settings& settings) {
  constexpr float degree = std::numbers::pi_v<float> / 180;
  const Eigen::AngleAxisf turn(settings.light_turn * degree, Vec3::UnitY());
  const Eigen::AngleAxisf tilt(settings.light_tilt * degree, Vec3::UnitX());
  return (turn * tilt).toRotationMatrix();
}

} // namespace

Settings settings_of(const WindowInput& input) {
  Settings settings;
  settings.against = input.against.empty() ? 0 : 1;
  settings.light = input.lighting == Lighting::Environment ? 1 : 0;
  settings.exposure = static_cast<float>(input.exposure);
  settings.level = input.level.value_or(automatic_level);
  settings.tolerance = input.tolerance;
  settings.panel = !input.bare;
  return settings;
}

void steer(const Gestures& gestures, const CameraDescription& start, Orbit& orbit,
           Settings& settings) {
  if (gestures.reset) {
    orbit = Orbit(start);
    settings.light_turn = settings.light_tilt = 0;
  }
  orbit.turn(-degrees_per_pixel * gestures.orbit_x, degrees_per_pixel * gestures.orbit_y);
  orbit.enlarge(std::pow(1.1, gestures.wheel));
  settings.light_turn = std::remainder(moved(settings.light_turn, gestures.light_x), 360.0F);
  settings.light_tilt = std::clamp(moved(settings.light_tilt, gestures.light_y), -90.0F, 90.0F);
  settings.panel = settings.panel != gestures.panel;
}

Look look_of(const Settings& settings, const Orbit& orbit, const Lamp& lamp, bool hurried) {
  Look look;
  look.camera = orbit.camera();
  look.to_world = rotation_of(settings);
  look.lamp = lamp;
  look.lamp.place = look.to_world * lamp.place;
  look.tolerance = std::max(settings.tolerance, hurried ? hurried_tolerance : 0);
  look.level = settings.level;
  return look;
}

} // namespace haarlight::view
