#include "samplers/sampler_factories.h"

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
                     .needs = NeedsLightTree | NeedsMaterialTrees | NeedsLightDistribution,
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
                     .summary = "the reflectance alone: its model's own routine, or its tree",
                     .needs = NeedsLobes},
          .make = make_brdf_factory},
    Entry{.traits = {.kind = SamplerKind::Mis,
                     .name = "mis",
                     .summary = "half light, half brdf, balance heuristic (Veach and Guibas 1995)",
                     .needs = NeedsLightDistribution | NeedsLobes},
          .make = make_mis_factory},
    Entry{.traits = {.kind = SamplerKind::Factored,
                     .name = "factored",
                     .summary = "the reflectance alone, factorised (Lawrence et al. 2004)",
                     .needs = NeedsNothing},
          .make = make_factored_factory},
    Entry{.traits = {.kind = SamplerKind::Alias,
                     .name = "alias",
                     .summary = "the probe's pixels by an alias table (Walker 1974, Vose 1991)",
                     .needs = NeedsLightDistribution},
          .make = make_alias_factory},
    Entry{.traits = {.kind = SamplerKind::MedianCut,
                     .name = "median-cut",
                     .summary = "lamps for regions of equal energy (Debevec 2005)",
                     .needs = NeedsNothing,
                     .bias = Bias::Biased},
          .make = make_median_cut_factory},
    Entry{.traits = {.kind = SamplerKind::KolligKeller,
                     .name = "kollig-keller",
                     .summary = "lamps by weighted relaxation (Kollig and Keller 2003)",
                     .needs = NeedsNothing,
                     .bias = Bias::Biased},
          .make = make_kollig_keller_factory},
    Entry{.traits = {.kind = SamplerKind::Structured,
                     .name = "structured",
                     .summary = "lamps in strata of like brightness (Agarwal et al. 2003)",
                     .needs = NeedsNothing,
                     .bias = Bias::Biased},
          .make = make_structured_factory},
    Entry{.traits = {.kind = SamplerKind::Ostromoukhov,
                     .name = "ostromoukhov",
                     .summary = "lamps on a Penrose tiling (Ostromoukhov et al. 2004)",
                     .needs = NeedsNothing,
                     .bias = Bias::Biased},
          .make = make_ostromoukhov_factory},
    Entry{.traits = {.kind = SamplerKind::MisPower,
                     .name = "mis-power",
                     .summary = "half light, half brdf, power heuristic (Veach and Guibas 1995)",
                     .needs = NeedsLightDistribution | NeedsMaterialTrees},
          .make = make_mis_power_factory},
    Entry{.traits = {.kind = SamplerKind::BisReject,
                     .name = "bis-reject",
                     .summary = "their product, by rejection (Burke et al. 2005)",
                     .needs = NeedsLightDistribution | NeedsMaterialTrees,
                     .bias = Bias::Biased},
          .make = make_bis_reject_factory},
    Entry{.traits = {.kind = SamplerKind::BisSir,
                     .name = "bis-sir",
                     .summary = "their product, by resampling one pool (Burke et al. 2005)",
                     .needs = NeedsLightDistribution | NeedsMaterialTrees},
          .make = make_bis_sir_factory},
    Entry{.traits = {.kind = SamplerKind::Ris,
                     .name = "ris",
                     .summary = "one of M candidates of both for each sample (Talbot et al. 2005)",
                     .needs = NeedsLightDistribution | NeedsMaterialTrees},
          .make = make_ris_factory},
    Entry{.traits = {.kind = SamplerKind::TwoStage,
                     .name = "two-stage",
                     .summary =
                         "the probe divided by the BRDF, summed-area table (Cline et al. 2006)",
                     .needs = NeedsMaterialTrees},
          .make = make_two_stage_factory},
    Entry{.traits = {.kind = SamplerKind::Wais,
                     .name = "wais",
                     .summary = "hash-table product of the nearest entries of two tables "
                                "(Clarberg et al. 2005)",
                     .needs = NeedsTables,
                     .bias = Bias::Biased},
          .make = make_wais_factory},
    Entry{.traits = {.kind = SamplerKind::Pps,
                     .name = "pps",
                     .summary = "the light tree times a quadtree of BRDF values made on the fly "
                                "(after Clarberg and Akenine-Möller 2008)",
                     .needs = NeedsLightTree | NeedsMaterialTrees},
          .make = make_pps_factory},
    Entry{.traits = {.kind = SamplerKind::ProductVisibility,
                     .name = "product-visibility",
                     .summary = "as product, times what is seen past the scene's objects",
                     .needs = NeedsLightTree | NeedsMaterialTrees | NeedsLightDistribution,
                     .follows_product = true},
          .make = make_product_visibility_factory},
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
