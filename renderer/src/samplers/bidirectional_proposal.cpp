#include "samplers/bidirectional_proposal.h"

#include <algorithm>

namespace haarlight::renderer {

ProposalBounds::ProposalBounds(const LoadedScene& scene) : m_light(scene.light()), m_peaks(scene) {
  constexpr std::size_t count = 16384;
  std::vector<Vec2> points(count);
  fill_points(Points::Sobol, 0, 0, points);
  std::vector<probe::LightSample> samples(count);
  m_light.sample(points, samples);
  for (const probe::LightSample& s : samples) {
    const float value = luminance(m_light.radiance(s.direction));
    m_power += s.pdf > 0 ? value / s.pdf / static_cast<float>(count) : 0.0F;
    m_brightest = std::max(m_brightest, value);
  }
}

void BidirectionalProposal::prepare(const ShadingPoint& point, const Material& material) {
  const LobePeak& peak = m_bounds->peaks().at(point, material);
  const float of_light = m_bounds->power() * peak.value;
  const float of_lobe = m_bounds->brightest() * peak.albedo;
  m_from_light = of_light <= of_lobe;
  m_bound = std::min(of_light, of_lobe);
  m_lobe.prepare(point, material);
}

void BidirectionalProposal::sample(const PointSource& points, std::span<DirectionSample> out) {
  m_points.resize(out.size());
  points.fill(m_from_light ? 0 : 1, m_points);
  if (!m_from_light)
    return m_lobe.sample(m_points, out);
  m_samples.resize(out.size());
  m_bounds->light().sample(m_points, m_samples);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {m_samples[i].direction, m_samples[i].pdf};
}

} // namespace haarlight::renderer
