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
    Entry{{SamplerKind::Product, "product",
           "one light tree times the BRDF's averages, built on the fly",
           NeedsLightTree | NeedsMaterialTrees | NeedsLightDistribution, Bias::Unbiased, true},
          make_product_factory},
    Entry{{SamplerKind::ProductTable, "product-table",
           "the stored trees of the nearest entries of two tables", NeedsTables, Bias::Unbiased,
           true},
          make_product_table_factory},
    Entry{{SamplerKind::Light, "light", "the probe's pixels by inversion of their cdf",
           NeedsLightDistribution, Bias::Unbiased, false},
          make_light_factory},
    Entry{{SamplerKind::Brdf, "brdf", "the reflectance alone: its model's own routine, or its tree",
           NeedsLobes, Bias::Unbiased, false},
          make_brdf_factory},
    Entry{{SamplerKind::Mis, "mis",
           "half light, half brdf, balance heuristic (Veach and Guibas 1995)",
           NeedsLightDistribution | NeedsLobes, Bias::Unbiased, false},
          make_mis_factory},
    Entry{{SamplerKind::Factored, "factored",
           "the reflectance alone, factorised (Lawrence et al. 2004)", NeedsNothing, Bias::Unbiased,
           false},
          make_factored_factory},
    Entry{{SamplerKind::Alias, "alias",
           "the probe's pixels by an alias table (Walker 1974, Vose 1991)", NeedsLightDistribution,
           Bias::Unbiased, false},
          make_alias_factory},
    Entry{{SamplerKind::MedianCut, "median-cut",
           "representative lights of regions of equal energy (Debevec 2005)", NeedsNothing,
           Bias::Biased, false},
          make_median_cut_factory},
    Entry{{SamplerKind::KolligKeller, "kollig-keller",
           "representative lights by weighted relaxation (Kollig and Keller 2003)", NeedsNothing,
           Bias::Biased, false},
          make_kollig_keller_factory},
    Entry{{SamplerKind::Structured, "structured",
           "representative lights in strata of similar brightness (Agarwal et al. 2003)",
           NeedsNothing, Bias::Biased, false},
          make_structured_factory},
    Entry{{SamplerKind::Ostromoukhov, "ostromoukhov",
           "representative lights on a Penrose tiling (Ostromoukhov et al. 2004)", NeedsNothing,
           Bias::Biased, false},
          make_ostromoukhov_factory},
    Entry{{SamplerKind::MisPower, "mis-power",
           "half light, half brdf, power heuristic (Veach and Guibas 1995)",
           NeedsLightDistribution | NeedsMaterialTrees, Bias::Unbiased, false},
          make_mis_power_factory},
    Entry{{SamplerKind::BisReject, "bis-reject",
           "the product of both, by rejection (Burke et al. 2005)",
           NeedsLightDistribution | NeedsMaterialTrees, Bias::Biased, false},
          make_bis_reject_factory},
    Entry{{SamplerKind::BisSir, "bis-sir",
           "the product of both, by resampling one pool (Burke et al. 2005)",
           NeedsLightDistribution | NeedsMaterialTrees, Bias::Unbiased, false},
          make_bis_sir_factory},
    Entry{{SamplerKind::Ris, "ris",
           "one of M candidates of both for each sample (Talbot et al. 2005)",
           NeedsLightDistribution | NeedsMaterialTrees, Bias::Unbiased, false},
          make_ris_factory},
    Entry{{SamplerKind::TwoStage, "two-stage",
           "the probe divided by the BRDF, summed-area table (Cline et al. 2006)",
           NeedsMaterialTrees, Bias::Unbiased, false},
          make_two_stage_factory},
    Entry{{SamplerKind::Wais, "wais",
           "hash-table product of the nearest entries of two tables (Clarberg et al. 2005)",
           NeedsTables, Bias::Biased, false},
          make_wais_factory},
    Entry{{SamplerKind::Pps, "pps",
           "the light tree times a quadtree of BRDF values made on the fly (after Clarberg and "
           "Akenine-Möller 2008)",
           NeedsLightTree | NeedsMaterialTrees, Bias::Unbiased, false},
          make_pps_factory},
    Entry{{SamplerKind::ProductVisibility, "product-visibility",
           "as product, times the visibility past the scene's objects",
           NeedsLightTree | NeedsMaterialTrees | NeedsLightDistribution, Bias::Unbiased, true},
          make_product_visibility_factory},
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
