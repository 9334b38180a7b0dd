#pragma once
// The list of samplers: their names and the data they need.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace haarlight::renderer {

enum class SamplerKind : std::uint8_t {
  Product,
  ProductTable,
  Light,
  Brdf,
  Mis,
  Factored,
  Alias,
  MedianCut,
  KolligKeller,
  Structured,
  Ostromoukhov,
  MisPower,
  BisReject,
  BisSir,
  Ris,
  TwoStage,
  Wais,
  Pps,
  ProductVisibility
};

/// Data that a sampler needs when a scene is loaded; bits.
enum SamplerNeed : unsigned {
  NeedsNothing = 0,
  NeedsLightTree = 1,         ///< the light's tree in the world's frame
  NeedsLightDistribution = 2, ///< the distribution of the probe's pixels
  NeedsMaterialTrees = 4,     ///< the θ_r-only sets
  NeedsTables = 8,            ///< the paper's tables, named by the scene
  NeedsLobes = 16 ///< the θ_r-only sets of materials without their own sampling routine
};

/// Whether the mean of the estimate is the integral.
enum class Bias : std::uint8_t {
  Unbiased, ///< densities are exact, or in expectation
  Biased    ///< as published: directions represent regions, or some directions have no density
};

struct SamplerTraits {
  SamplerKind kind;
  const char* name;    ///< as on the command line
  const char* summary; ///< the density, and its source
  unsigned needs;      ///< of SamplerNeed
  Bias bias = Bias::Unbiased;
  bool follows_product =
      false; ///< has L_ns of the paper's eq. 8, and directions follow the product
};

/// All samplers in the order of SamplerKind.
std::span<const SamplerTraits> samplers();

const SamplerTraits& traits(SamplerKind kind);

std::optional<SamplerKind> sampler_from_name(const std::string& name);
inline std::string sampler_name(SamplerKind kind) { return traits(kind).name; }

inline bool needs(SamplerKind kind, SamplerNeed what) { return (traits(kind).needs & what) != 0; }

} // namespace haarlight::renderer
