#include "sampler_kinds.h"

#include <array>

namespace haarlight::renderer {
namespace {

constexpr std::array<std::pair<const char*, SamplerKind>, 5> names = {
    {{"product", SamplerKind::Product},
     {"product-table", SamplerKind::ProductTable},
     {"light", SamplerKind::Light},
     {"brdf", SamplerKind::Brdf},
     {"mis", SamplerKind::Mis}}};

} // namespace

std::optional<SamplerKind> sampler_from_name(const std::string& name) {
  for (const auto& [text, kind] : names)
    if (name == text)
      return kind;
  return std::nullopt;
}

std::string sampler_name(SamplerKind kind) { return names[static_cast<std::size_t>(kind)].first; }

std::unique_ptr<Sampler> make_sampler(SamplerKind kind, const Light& light,
                                      const wavelet::AdaptiveOptions& options) {
  switch (kind) {
  case SamplerKind::Product:
    return make_product_sampler(light, options);
  case SamplerKind::ProductTable:
    return make_table_sampler(light);
  case SamplerKind::Light:
    return make_light_sampler(light);
  case SamplerKind::Brdf:
    return make_brdf_sampler();
  case SamplerKind::Mis:
    return make_mis_sampler(light);
  }
  return nullptr;
}

bool needs_light_tree(SamplerKind kind) { return kind == SamplerKind::Product; }

bool needs_light_distribution(SamplerKind kind) {
  return kind == SamplerKind::Light || kind == SamplerKind::Mis;
}

bool needs_material_trees(SamplerKind kind) {
  return kind == SamplerKind::Product || kind == SamplerKind::Brdf || kind == SamplerKind::Mis;
}

} // namespace haarlight::renderer
