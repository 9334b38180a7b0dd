// Multiple importance sampling with the balance heuristic.

#include "samplers/mis_sampler.h"
#include "samplers/sampler_factories.h"

namespace haarlight::renderer {

std::unique_ptr<SamplerFactory> make_mis_factory(const LoadedScene& scene,
                                                 const SamplerOptions& /*options*/) {
  return simple_factory<MisSampler<BalanceHeuristic>>(std::cref(scene.light()));
}

} // namespace haarlight::renderer
