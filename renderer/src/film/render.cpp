#include <renderer/film/render.h>

#include "film/film_rendering.h"
#include "light/light_samples.h"

#include <array>

namespace haarlight::renderer {
namespace {

constexpr std::array<std::pair<const char*, Estimator>, 3> estimator_names = {
    {{"unbiased", Estimator::Unbiased},
     {"bidirectional", Estimator::Bidirectional},
     {"ratio", Estimator::Ratio}}};

/// Direct light.
class DirectShader : public PixelShader {
public:
  DirectShader(const LoadedScene& scene, const RenderOptions& options,
               const RenderFactories& factories)
      : m_estimator(options.estimator), m_light(scene, options, factories) {}

  void reset() override { m_light.reset(); }

  void shade(const PixelHit& seen, const Pass& pass, PixelSums& sums) override {
    m_light.prepare(seen, m_cost);
    if (const auto unshadowed = m_light.unshadowed())
      sums.product = *unshadowed;
    m_light.sample(pass);
    m_contributions.resize(pass.count);
    for (std::size_t i = 0; i < pass.count; ++i) {
      const bool visible =
          m_estimator == Estimator::Bidirectional ? add_direction(i, sums) : m_light.visible(i);
      const Rgb weight = m_light.weight(i);
      sums.add(weight, visible, m_light.pdf(i));
      m_contributions[i] = m_light.contribution(i, weight, visible);
    }
    sums.add_variance(m_light.variance_of_sums(m_contributions), pass.count);
  }

private:
  bool add_direction(std::size_t i, PixelSums& sums) const {
    const std::optional<bool> unoccluded = m_light.unoccluded(i);
    if (unoccluded)
      sums.add_direction(*unoccluded);
    return unoccluded.value_or(false);
  }

  Estimator m_estimator;
  LightSamples m_light;
  std::vector<Contribution> m_contributions; ///< of the pass's samples
};

SamplerOptions sampling_of(const RenderOptions& options) {
  SamplerOptions result = options.sampling;
  result.count = static_cast<std::size_t>(options.spp);
  if (!needs_unshadowed(options.estimator))
    return result;
  result.product.reuse_variance_bound = 0; // each point needs its own product
  if (result.product.variance_bound == 0)
    result.product.variance_bound = integral_variance_bound;
  return result;
}

} // namespace

std::optional<Estimator> estimator_from_name(const std::string& name) {
  for (const auto& [text, estimator] : estimator_names)
    if (name == text)
      return estimator;
  return std::nullopt;
}

std::string estimator_name(Estimator estimator) {
  return estimator_names[static_cast<std::size_t>(estimator)].first;
}

std::optional<std::string> validate(SamplerKind sampler, Estimator estimator) {
  if (estimator == Estimator::Bidirectional && !traits(sampler).follows_product)
    return "the bidirectional estimator needs directions that follow the product: --sampler "
           "product or "
           "product-table";
  return std::nullopt;
}

RenderFactories::RenderFactories(const LoadedScene& scene, const RenderOptions& options)
    : sampler(make_sampler_factory(options.sampler, scene, sampling_of(options))) {
  if (needs_unshadowed(options.estimator) && !traits(options.sampler).follows_product)
    integrator = make_sampler_factory(SamplerKind::Product, scene, sampling_of(options));
}

RenderResult render(const LoadedScene& scene, const RenderFactories& factories,
                    const RenderOptions& options, int width, int height,
                    const RenderProgress& progress) {
  const auto make = [&] { return std::make_unique<DirectShader>(scene, options, factories); };
  return render_film(scene, options, make, width, height, progress);
}

RenderResult render(const LoadedScene& scene, const RenderOptions& options, int width, int height,
                    const RenderProgress& progress) {
  return render(scene, RenderFactories(scene, options), options, width, height, progress);
}

} // namespace haarlight::renderer
