#pragma once
// How high reflectances rise, by θ_r: what samplers that bound a reflectance start from.

#include <renderer/scene/loaded_scene.h>

#include <vector>

namespace haarlight::renderer {

/// Of f_r cos seen at one θ_r, luminance.
struct LobePeak {
  float value = 0;  ///< the highest found, sr⁻¹
  float albedo = 0; ///< ∫ f_r cos dω
};

/// The peaks of a scene's materials, found by drawing directions from their trees and evaluating
/// the reflectance itself: near the true maximum, but no bound that holds without exception.
class LobePeaks {
public:
  /// After require_trees() of its materials. The scene must outlive this.
  explicit LobePeaks(const LoadedScene& scene);

  /// Of the θ_r cell a point lies in.
  const LobePeak& at(const ShadingPoint& point, const Material& material) const;

private:
  static constexpr int cells = 64; ///< of θ_r for each material

  const std::vector<Material>& m_materials;
  std::vector<LobePeak> m_peaks;
};

} // namespace haarlight::renderer
