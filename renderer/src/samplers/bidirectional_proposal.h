#pragma once
// What bidirectional importance sampling draws its candidates from: light or reflectance.

#include "samplers/lobe_peaks.h"
#include "samplers/lobe_sampling.h"

#include <memory>

namespace haarlight::renderer {

/// What all threads know of the light and the reflectances.
class ProposalBounds {
public:
  explicit ProposalBounds(const LoadedScene& scene);

  const Light& light() const { return m_light; }
  const LobePeaks& peaks() const { return m_peaks; }
  float power() const { return m_power; }
  float brightest() const { return m_brightest; }

private:
  const Light& m_light;
  LobePeaks m_peaks;
  float m_power = 0;     ///< ∫ lum L dω
  float m_brightest = 0; ///< lum L
};

/// Of q ∝ L and q ∝ f_r cos the one whose largest weight f_r L cos / q is the smaller, which
/// accepts more: for each point and its θ_r.
class BidirectionalProposal {
public:
  explicit BidirectionalProposal(std::shared_ptr<const ProposalBounds> bounds)
      : m_bounds(std::move(bounds)) {}

  void prepare(const ShadingPoint& point, const Material& material);

  /// Draws out.size() candidates, with their densities.
  void sample(const PointSource& points, std::span<DirectionSample> out);

  float pdf(const Vec3& direction) const {
    return m_from_light ? m_bounds->light().pdf(direction) : m_lobe.pdf(direction);
  }

  /// What weights do not surpass, but for rare ones.
  float bound() const { return m_bound; }

private:
  std::shared_ptr<const ProposalBounds> m_bounds;
  Lobe m_lobe;
  bool m_from_light = true;
  float m_bound = 0;
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

} // namespace haarlight::renderer
