#pragma once
// A camera that goes round what it looks at.

#include <renderer/scene/scene.h>

namespace haarlight::view {

/// Keeps what the camera looks at, its up and its projection.
class Orbit {
public:
  explicit Orbit(const renderer::CameraDescription& start);

  /// The camera goes to the right about its up, and upwards, degrees; it stops a degree before
  /// `up` and its opposite.
  void turn(double right, double up);
  /// Shows everything larger by this factor, > 0: from a smaller distance, or for an orthographic
  /// camera in a lower picture. In all at most a thousandfold, or a thousandth.
  void enlarge(double factor);

  renderer::CameraDescription camera() const;

private:
  renderer::CameraDescription m_start;
  double m_distance;
  double m_right = 0; ///< degrees from the start
  double m_above;     ///< degrees above the plane through `to` that `up` is normal to
  double m_scale = 1; ///< of distance or height
};

} // namespace haarlight::view
