#pragma once
// Samplers of light directions at a shading point: one small interface, one file each.

#include <renderer/light.h>
#include <renderer/material.h>
#include <renderer/points.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace haarlight::renderer {

enum class SamplerKind {
  Product,      ///< world-frame product of one light tree and the θ_r-only set, adaptive
  ProductTable, ///< the paper's: product of the two stored trees of the nearest table entries
  Light,        ///< the light alone, by cdf inversion (or its tree, if there is no probe)
  Brdf,         ///< the reflectance alone, by descent in its tree
  Mis ///< half of the samples from each of the two, balance heuristic (Veach and Guibas 1995)
};

/// As on the command line: product, product-table, light, brdf, mis.
std::optional<SamplerKind> sampler_from_name(const std::string& name);
std::string sampler_name(SamplerKind kind);

/// A direction and the density it counts with. For several techniques at once this is their mean
/// density, weighted by their numbers of samples, which makes f/pdf the balance heuristic.
struct DirectionSample {
  Vec3 direction; ///< unit, in the light's frame
  float pdf = 0;  ///< sr⁻¹; 0 = no direction could be drawn, it contributes nothing
};

/// Where a pixel's random points come from.
struct PointSource {
  Points kind = Points::Sobol;
  std::uint32_t key = 0;   ///< of the pixel and the seed
  std::uint32_t first = 0; ///< index of the first sample, for later passes over the same pixel

  void fill(std::uint32_t dimension, std::span<Vec2> out) const {
    fill_points(kind, hash_words(key, dimension), first, out);
  }
};

/// Draws directions for one point after another; each thread has its own.
class Sampler {
public:
  virtual ~Sampler() = default;

  /// Turns to a point. What it refers to must live until the next call.
  virtual void prepare(const ShadingPoint& point, const Material& material) = 0;

  /// Draws out.size() directions for the point.
  virtual void sample(const PointSource& points, std::span<DirectionSample> out) = 0;

  /// Density of the directions that sample() draws `count` at a time, at any direction, sr⁻¹.
  virtual float pdf(const Vec3& direction, std::size_t count) const = 0;

  /// The point's unshadowed radiance as this sampler's product knows it, L_ns of the paper's eq. 8;
  /// nothing for samplers that have no product.
  virtual std::optional<Rgb> unshadowed() const { return std::nullopt; }

  /// Leaves of the product at hand, 0 without one.
  virtual std::size_t leaves() const { return 0; }
};

/// @throws Error(Input) if the scene lacks what the sampler needs
/// @param light after need_tree() or need_distribution() as needs_… say
std::unique_ptr<Sampler> make_sampler(SamplerKind kind, const Light& light,
                                      const wavelet::AdaptiveOptions& options);

/// What a sampler wants made beforehand.
bool needs_light_tree(SamplerKind kind);
bool needs_light_distribution(SamplerKind kind);
bool needs_material_trees(SamplerKind kind);

} // namespace haarlight::renderer
