#pragma once
// A light that turns, as maps of one resolution.

#include <renderer/light/light.h>

#include <probe/probe_maps.h>

namespace haarlight::renderer {

/// A rotation of the world: about +y by yaw, then about +x by pitch, then about +z by roll, all
/// fixed axes, right-handed, degrees. With yaw alone it is what the scene's "rotate" does.
Eigen::Matrix3f turn_of(const Eigen::Vector3d& yaw_pitch_roll);

/// A light's map at any turn.
class TurnedLight {
public:
  /// @param resolution pixels along a side of the maps, a power of two ≥ 4
  TurnedLight(const Light& light, int resolution);

  /// The light turned about the world's origin on top of the scene's own turn, as a map in the
  /// light's frame: that in which the scene places it, which does not turn along.
  wavelet::Map map(const Eigen::Matrix3f& turn) const;

private:
  int m_resolution;
  Eigen::Matrix3f m_placed; ///< from the light's frame to the world
  probe::RotatableMap m_level;
};

} // namespace haarlight::renderer
