#pragma once
// The light of a transfer, turned: what changes from one picture to the next.

#include <view/packed_scene.h>

#include <renderer/transfer/relight.h>

#include <vector>

namespace haarlight::view {

class TransferLight {
public:
  /// @param points of the film, by pixel; must outlive this
  /// @throws Error(Input) if the light's files cannot be read
  TransferLight(const renderer::Transfer& transfer, const renderer::SceneDescription& scene,
                const std::vector<renderer::FilmPoint>& points);

  /// What relight.glsl reads of the light turned about the world's origin: its coefficients, and
  /// `surroundings`, the light itself in the pixels where nothing is hit.
  PackedScene turned(const Eigen::Matrix3f& turn) const;

private:
  PackedTexture surroundings(const Eigen::Matrix3f& turn) const;

  int m_width;
  int m_height;
  bool m_shown;
  renderer::Light m_light;
  renderer::RotatedLight m_map;
  const std::vector<renderer::FilmPoint>& m_points;
};

} // namespace haarlight::view
