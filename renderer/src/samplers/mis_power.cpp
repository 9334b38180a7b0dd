// Multiple importance sampling with the power heuristic, β = 2 (Veach and Guibas 1995; Veach 1997,
// section 9.2.3).

#include "samplers/kinds.h"
#include "samplers/mis_sampler.h"

#include <algorithm>

namespace haarlight::renderer {
namespace {

/// w_i = s_i² / Σ s_k².
struct PowerHeuristic {
  static float density(float own, float other) {
    // The square of a sharp lobe's density over a tiny one must stay finite.
    return own > 0 ? std::min(own + other * (other / own), 1e30F) : 0.0F;
  }

  static float weight(float own, float other) {
    const float balance = own / (own + other);
    return balance * balance / (balance * balance + (1 - balance) * (1 - balance));
  }
};

} // namespace

std::unique_ptr<SamplerFactory> make_mis_power_factory(const LoadedScene& scene,
                                                       const SamplerOptions& /*options*/) {
  return simple_factory<MisSampler<PowerHeuristic>>(std::cref(scene.light()));
}

} // namespace haarlight::renderer
