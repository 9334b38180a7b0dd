// Bidirectional importance sampling by sampling-importance resampling (Burke, Ghosh and Heidrich
// 2005): of M candidates for each of N samples, all M N together, N are chosen.

#include "samplers/bidirectional_sampler.h"
#include "samplers/sampler_factories.h"

#include <limits>

namespace haarlight::renderer {
namespace {

class BisSirSampler : public BidirectionalSampler {
public:
  using BidirectionalSampler::BidirectionalSampler;

private:
  std::size_t sample_round(const PointSource& points, std::span<DirectionSample> out) override {
    draw(points, candidates_of(out.size()), std::numeric_limits<float>::max());
    resample(points, out);
    return 0;
  }
};

} // namespace

std::unique_ptr<SamplerFactory> make_bis_sir_factory(const LoadedScene& scene,
                                                     const SamplerOptions& options) {
  return simple_factory<BisSirSampler>(std::make_shared<const ProposalBounds>(scene),
                                       options.candidates);
}

} // namespace haarlight::renderer
