#include "kinds.h"

#include <array>

namespace haarlight::renderer {
namespace {

struct Entry {
  SamplerTraits traits;
  MakeFactory* make;
};

/// In the order of SamplerKind.
constexpr std::array entries = {
    Entry{.traits = {.kind = SamplerKind::Product,
                     .name = "product",
                     .summary = "one light tree times the BRDF's averages, built on the fly",
                     .needs = NeedsLightTree | NeedsMaterialTrees,
                     .follows_product = true},
          .make = make_product_factory},
    Entry{.traits = {.kind = SamplerKind::ProductTable,
                     .name = "product-table",
                     .summary = "the stored trees of the nearest entries of two tables",
                     .needs = NeedsTables,
                     .follows_product = true},
          .make = make_product_table_factory},
    Entry{.traits = {.kind = SamplerKind::Light,
                     .name = "light",
                     .summary = "the probe's pixels by inversion of their cdf",
                     .needs = NeedsLightDistribution},
          .make = make_light_factory},
    Entry{.traits = {.kind = SamplerKind::Brdf,
                     .name = "brdf",
                     .summary = "the reflectance alone, by descent in its tree",
                     .needs = NeedsMaterialTrees},
          .make = make_brdf_factory},
    Entry{.traits = {.kind = SamplerKind::Mis,
                     .name = "mis",
                     .summary = "half light, half brdf, balance heuristic (Veach and Guibas 1995)",
                     .needs = NeedsLightDistribution | NeedsMaterialTrees},
          .make = make_mis_factory},
    Entry{.traits = {.kind = SamplerKind::Wais,
                     .name = "wais",
                     .summary = "hash-table product of the nearest entries of two tables "
                                "(Clarberg et al. 2005)",
                     .needs = NeedsTables,
                     .claim = SamplerClaim::Biased},
          .make = make_wais_factory},
    Entry{.traits = {.kind = SamplerKind::Pps,
                     .name = "pps",
                     .summary = "the light tree times a quadtree of BRDF values made on the fly "
                                "(after Clarberg and Akenine-Möller 2008)",
                     .needs = NeedsLightTree | NeedsMaterialTrees},
          .make = make_pps_factory},
};

constexpr auto all_traits = [] {
  std::array<SamplerTraits, entries.size()> result{};
  for (std::size_t i = 0; i < entries.size(); ++i)
    result[i] = entries[i].traits;
  return result;
}();

constexpr bool in_order() {
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (static_cast<std::size_t>(entries[i].traits.kind) != i)
      return false;
  return true;
}
static_assert(in_order());

} // namespace

std::span<const SamplerTraits> samplers() { return all_traits; }

const SamplerTraits& traits(SamplerKind kind) { return all_traits[static_cast<std::size_t>(kind)]; }

std::optional<SamplerKind> sampler_from_name(const std::string& name) {
  for (const SamplerTraits& sampler : samplers())
    if (name == sampler.name)
      return sampler.kind;
  return std::nullopt;
}

std::unique_ptr<SamplerFactory> make_sampler_factory(SamplerKind kind, const LoadedScene& scene,
                                                     const SamplerOptions& options) {
  return entries[static_cast<std::size_t>(kind)].make(scene, options);
}

} // namespace haarlight::renderer
