// Importance resampling (Talbot, Cline and Egbert 2005): of M candidates for each sample, half from
// the light and half from the reflectance, one is chosen in proportion to the luminance of f_r L
// cos over their mean density, and counts with its target over the mean weight of its own M.

#include "samplers/candidate_pool.h"
#include "samplers/mis_sampler.h"
#include "samplers/sampler_factories.h"

#include <algorithm>

namespace haarlight::renderer {
namespace {

class RisSampler : public Sampler {
public:
  RisSampler(const Light& light, int candidates)
      : m_light(light), m_proposal(light),
        m_pairs(static_cast<std::size_t>(std::max(1, candidates / 2))) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_point = &point;
    m_material = &material;
    m_proposal.prepare(point, material);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_numbers.resize(out.size());
    points.fill(3, m_numbers);
    const std::size_t round = std::max<std::size_t>(1, round_candidates / (2 * m_pairs));
    for (std::size_t i = 0; i < out.size(); i += round) {
      const std::size_t count = std::min(round, out.size() - i);
      draw({points.kind, points.key, points.first + static_cast<std::uint32_t>(i)}, count);
      for (std::size_t k = 0; k < count; ++k)
        out[i + k] = choose(k, count, m_numbers[i + k].x());
    }
  }

  float pdf(const Vec3& direction, std::size_t count) const override {
    return m_proposal.pdf(direction, 2 * m_pairs * count);
  }

private:
  static constexpr std::size_t round_candidates = 4096; ///< that stay in the cache

  void draw(PointSource points, std::size_t count) {
    points.first *= static_cast<std::uint32_t>(m_pairs);
    m_pool.clear();
    m_proposal.sample(points, m_pool.extend(2 * m_pairs * count));
    m_pool.weigh(m_light, *m_point, *m_material);
  }

  /// From the k-th part of those from the light, and that of those from the reflectance.
  DirectionSample choose(std::size_t k, std::size_t count, float u) const {
    const std::size_t light = k * m_pairs;
    const std::size_t lobe = (count + k) * m_pairs;
    const double from_light = m_pool.sum(light, light + m_pairs);
    const double sum = from_light + m_pool.sum(lobe, lobe + m_pairs);
    if (!(sum > 0))
      return {Vec3::UnitZ(), 0};
    const double place = static_cast<double>(u) * sum;
    const std::size_t i = place < from_light
                              ? m_pool.choose(light, light + m_pairs, place)
                              : m_pool.choose(lobe, lobe + m_pairs, place - from_light);
    return m_pool.chosen(i, sum / static_cast<double>(2 * m_pairs));
  }

  const Light& m_light;
  MisSampler<BalanceHeuristic> m_proposal;
  std::size_t m_pairs; ///< of candidates for each sample, one from the light, one from the lobe
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  CandidatePool m_pool;
  std::vector<Vec2> m_numbers;
};

} // namespace

std::unique_ptr<SamplerFactory> make_ris_factory(const LoadedScene& scene,
                                                 const SamplerOptions& options) {
  return simple_factory<RisSampler>(std::cref(scene.light()), options.candidates);
}

} // namespace haarlight::renderer
