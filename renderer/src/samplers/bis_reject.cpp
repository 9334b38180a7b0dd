// Bidirectional importance sampling by rejection (Burke, Ghosh and Heidrich 2005): candidates are
// accepted with probability weight / bound until there are enough samples, or for M tries each;
// what is then missing is resampled from the candidates tried.

#include "samplers/bidirectional_sampler.h"
#include "samplers/sampler_factories.h"

#include <algorithm>

namespace haarlight::renderer {
namespace {

class BisRejectSampler : public BidirectionalSampler {
public:
  using BidirectionalSampler::BidirectionalSampler;

private:
  static constexpr std::size_t batch = 64;

  std::size_t sample_round(const PointSource& points, std::span<DirectionSample> out) override {
    m_accepted.clear();
    const std::size_t most = candidates_of(out.size());
    while (m_accepted.size() < out.size() && pool().size() < most)
      try_batch(points, std::min(batch, most - pool().size()), out.size());
    for (std::size_t i = 0; i < m_accepted.size(); ++i)
      out[i] = take(m_accepted[i]);
    resample(points, out.subspan(m_accepted.size()));
    return m_accepted.size();
  }

  void try_batch(const PointSource& points, std::size_t count, std::size_t wanted) {
    const std::size_t first = pool().size();
    m_acceptance.resize(count);
    const auto index = static_cast<std::uint32_t>(candidates_of(points.first) + first);
    PointSource{points.kind, points.key, index}.fill(4, m_acceptance);
    draw(points, count, bound());
    for (std::size_t i = 0; i < count && m_accepted.size() < wanted; ++i)
      if (m_acceptance[i].x() * bound() < pool().weight(first + i))
        m_accepted.push_back(first + i);
  }

  std::vector<std::size_t> m_accepted;
  std::vector<Vec2> m_acceptance;
};

} // namespace

std::unique_ptr<SamplerFactory> make_bis_reject_factory(const LoadedScene& scene,
                                                        const SamplerOptions& options) {
  return simple_factory<BisRejectSampler>(std::make_shared<const ProposalBounds>(scene),
                                          options.candidates);
}

} // namespace haarlight::renderer
