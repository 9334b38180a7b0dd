#pragma once
// The factories behind make_sampler_factory().

#include <renderer/samplers/sampler.h>
#include <renderer/scene/loaded_scene.h>

#include <functional>

namespace haarlight::renderer {

/// A factory of samplers that share only the scene.
class SimpleFactory : public SamplerFactory {
public:
  using Make = std::function<std::unique_ptr<Sampler>()>;

  explicit SimpleFactory(Make make) : m_make(std::move(make)) {}
  std::unique_ptr<Sampler> make(std::size_t /*count*/) const override { return m_make(); }

private:
  Make m_make;
};

/// Creates samplers of class S, each constructed from copies of the arguments; use std::cref for
/// references.
template <class S, class... Arguments>
std::unique_ptr<SamplerFactory> simple_factory(Arguments... arguments) {
  return std::make_unique<SimpleFactory>([=] { return std::make_unique<S>(arguments...); });
}

/// The finest squares of a light without a probe, as an octahedral probe.
inline probe::Probe tree_as_probe(const Light& light) {
  const wavelet::Map map = light.map(1 << light.tree().levels);
  Image image(map.size, map.size);
  image.rgb = map.rgb;
  return {image, probe::Mapping::Octahedral};
}

using MakeFactory = std::unique_ptr<SamplerFactory>(const LoadedScene& scene,
                                                    const SamplerOptions& options);

MakeFactory make_light_factory;
MakeFactory make_brdf_factory;
MakeFactory make_mis_factory;
MakeFactory make_product_factory;
MakeFactory make_product_table_factory;
MakeFactory make_factored_factory;
MakeFactory make_alias_factory;
MakeFactory make_median_cut_factory;
MakeFactory make_kollig_keller_factory;
MakeFactory make_structured_factory;
MakeFactory make_ostromoukhov_factory;
MakeFactory make_mis_power_factory;
MakeFactory make_bis_reject_factory;
MakeFactory make_bis_sir_factory;
MakeFactory make_ris_factory;
MakeFactory make_two_stage_factory;
MakeFactory make_wais_factory;
MakeFactory make_pps_factory;
MakeFactory make_product_visibility_factory;

} // namespace haarlight::renderer
