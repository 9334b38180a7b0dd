#pragma once
// From user input to the camera, the light and the resolution of the window's pictures.

#include <view/frame.h>
#include <view/panel.h>
#include <view/screen.h>

#include <renderer/scene/scene.h>

namespace haarlight::view {

/// Degrees that camera and light rotate for each pixel of a drag.
inline constexpr double degrees_per_pixel = 0.4;

/// A camera on a sphere around the point that it looks at; that point, its up vector and its
/// projection stay constant.
class OrbitCamera {
public:
  explicit OrbitCamera(const renderer::CameraDescription& start);

  /// Moves the camera to the right about its up vector, and upwards, degrees; its elevation stays
  /// within ±89°.
  void orbit(double right, double up);
  /// Magnifies the picture by a factor > 0: a perspective camera comes closer, an orthographic one
  /// shows a smaller height. The total is limited to [1/1000, 1000].
  void zoom(double factor);

  renderer::CameraDescription camera() const;

private:
  renderer::CameraDescription m_start;
  double m_distance;
  double m_azimuth = 0; ///< degrees from the start
  double m_elevation;   ///< degrees above the plane through `to` whose normal is `up`
  double m_scale = 1;   ///< of distance or height
};

/// Chooses the resolution of the pictures: coarse while something moves, so that they follow at
/// once; then finer step by step as far as the time limit allows.
class ResolutionController {
public:
  /// @param fixed pictures always have full resolution
  explicit ResolutionController(bool fixed)
      : m_fixed(fixed), m_pixel_size(fixed ? 1 : largest_pixel_size) {}

  /// Call before the pictures are drawn.
  /// @param moving       whether anything moves
  /// @param full_time    estimated milliseconds of pictures of full resolution
  /// @param min_size     lower bound of pixel_size()
  void update(bool moving, double full_time, int min_size);

  /// Window pixels along a side of one drawn pixel.
  int pixel_size() const { return m_pixel_size; }
  /// Whether speed is more important than quality.
  bool interactive() const { return m_moving; }

private:
  static constexpr int largest_pixel_size = 8;

  bool m_fixed;
  bool m_moving = false;
  int m_pixel_size;
};

/// Applies mouse and keyboard input to the camera, the light and the panel.
/// @param start the camera after a reset
void apply_input(const UserInput& input, const renderer::CameraDescription& start,
                 OrbitCamera& orbit, Settings& settings);

/// The view that settings and camera define, without the environment and the picture's size.
/// @param punctual    before it is rotated
/// @param interactive use a larger tolerance
ViewState view_state(const Settings& settings, const OrbitCamera& orbit,
                     const PunctualLight& punctual, bool interactive);

} // namespace haarlight::view
