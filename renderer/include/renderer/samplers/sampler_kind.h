#pragma once
// The samplers there are, by name: what each is, and what it wants made before it.

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

/// What a sampler wants made when a scene is loaded; bits.
enum SamplerNeed : unsigned {
  NeedsNothing = 0,
  NeedsLightTree = 1,         ///< the light's tree in the world's frame
  NeedsLightDistribution = 2, ///< the probe's pixels as a distribution
  NeedsMaterialTrees = 4,     ///< the θ_r-only sets
  NeedsTables = 8,            ///< the paper's tables, which the scene must name
  NeedsLobes = 16 ///< the θ_r-only sets of materials that have no sampling routine of their own
};

/// What samplers return as density.
enum class Bias : std::uint8_t {
  Unbiased, ///< directions have the density they count with, or count so in expectation
  Biased    ///< as published: lamps stand for regions, or directions are overlooked
};

struct SamplerTraits {
  SamplerKind kind;
  const char* name;    ///< as on the command line
  const char* summary; ///< what it draws from, and whose it is
  unsigned needs;      ///< of SamplerNeed
  Bias bias = Bias::Unbiased;
  bool follows_product = false; ///< knows L_ns of the paper's eq. 8, and directions follow it
};

/// All samplers in the order of SamplerKind.
std::span<const SamplerTraits> samplers();

const SamplerTraits& traits(SamplerKind kind);

std::optional<SamplerKind> sampler_from_name(const std::string& name);
inline std::string sampler_name(SamplerKind kind) { return traits(kind).name; }

inline bool needs(SamplerKind kind, SamplerNeed what) { return (traits(kind).needs & what) != 0; }

} // namespace haarlight::renderer
