#pragma once
// Samplers of light directions at a shading point: one small interface, one file each.

#include <renderer/film/points.h>
#include <renderer/light/light.h>
#include <renderer/material/material.h>
#include <renderer/samplers/sampler_kind.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace haarlight::renderer {

class LoadedScene;

/// The technique that drew a sample. A sampler with two techniques draws a fixed number of samples
/// with each, so that the estimate varies within techniques only.
enum class Technique : std::uint8_t {
  First,
  Second,
  Fixed ///< the same direction for every seed
};
inline constexpr std::size_t random_techniques = 2; ///< First and Second

/// Weights of Technique::First at a direction, those of Second being the complements to 1.
struct FirstWeights {
  float balance = 1;   ///< n1 p1 / (n1 p1 + n2 p2), the balance heuristic's
  float heuristic = 1; ///< that of the heuristic by which samples count
};

/// A direction and the density it counts with. For several techniques at once this is their mean
/// density, weighted by their numbers of samples, which makes f/pdf the balance heuristic; for
/// resampled directions it is the reciprocal of the weight they count with.
struct DirectionSample {
  Vec3 direction; ///< unit, in the light's frame
  float pdf = 0;  ///< sr⁻¹; 0 = no direction could be drawn, it contributes nothing
  Technique technique = Technique::First;
  FirstWeights first = {}; ///< used where a technique drew a single sample
};

/// Variances and covariance of two sums over samples, Σ w v and Σ w: w is the luminance of a
/// sample's unshadowed contribution f_r L cos / pdf, v ∈ {0, 1} its visibility.
struct SumVariance {
  double shadowed = 0;
  double covariance = 0;
  double unshadowed = 0;

  SumVariance& operator+=(const SumVariance& other) {
    shadowed += other.shadowed;
    covariance += other.covariance;
    unshadowed += other.unshadowed;
    return *this;
  }
  SumVariance& operator*=(double factor) {
    shadowed *= factor;
    covariance *= factor;
    unshadowed *= factor;
    return *this;
  }
};

/// The point sets of a pixel's samples. Sets of different dimensions are independent of each other.
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

  /// Forgets the points before: what comes depends on the points to come alone.
  virtual void forget() {}

  /// Turns to a point, best one near the last. What it refers to must live until the next call.
  virtual void prepare(const ShadingPoint& point, const Material& material) = 0;

  /// Draws out.size() directions for the point.
  virtual void sample(const PointSource& points, std::span<DirectionSample> out) = 0;

  /// Density of the directions that sample() draws `count` at a time, at any direction, sr⁻¹; of
  /// resampled directions, of their candidates.
  virtual float pdf(const Vec3& direction, std::size_t count) const = 0;

  /// The radiance that the directions of the last sample() stand for: the light's own, unless they
  /// are lamps in place of regions.
  virtual void radiance(const Light& light, std::span<const Vec3> directions,
                        std::span<Rgb> out) const {
    light.radiance(directions, out);
  }

  /// The point's unshadowed radiance as this sampler's product knows it, L_ns of the paper's eq. 8;
  /// nothing for samplers that have no product.
  virtual std::optional<Rgb> unshadowed() const { return std::nullopt; }

  /// The part of the sums' variance that the samples of the last sample() have in common, besides
  /// that of independent samples: resampled ones share a pool of candidates.
  /// @param visible of each sample, not 0 if it is unoccluded
  virtual SumVariance shared_variance(std::span<const std::uint8_t> /*visible*/) const {
    return {};
  }

  /// Leaves of the product at hand, 0 without one.
  virtual std::size_t leaves() const { return 0; }
};

struct SamplerOptions {
  wavelet::AdaptiveOptions product = {.variance_bound =
                                          0}; ///< a bound of 0 goes by the count of
                                              ///< samples, see default_variance_bound()
  std::size_t count = 0; ///< samples that a pass is likely to ask for; what depends on the count is
                         ///< then made beforehand
  int candidates = 16;   ///< of resampling samplers for each sample, at most; above 0
  int regions = 512;     ///< that two-stage divides the light into, at most; 4 or more
  int pps_samples = 128; ///< BRDF values that `pps` begins with, ≥ 1
};

/// What products are refined to by default. The variance that leaves add falls as their number n
/// rises, like k/n, beside a part v that stays. With the time of N samples as that of r·N leaves,
/// (v + k/n)(r·N + n) is least at k/n = √(k·v/(r·N)): the bound goes by 1/√N.
/// @param count samples that are drawn from one product, > 0
float default_variance_bound(std::size_t count);

/// What the samplers of all threads share, made once for a scene; makes each thread's own.
class SamplerFactory {
public:
  virtual ~SamplerFactory() = default;

  /// @param count samples that each point is likely to be asked for, > 0
  virtual std::unique_ptr<Sampler> make(std::size_t count) const = 0;
};

/// @param scene loaded for this kind; must outlive the factory and its samplers
/// @throws Error(Input) if the scene lacks what the sampler needs
std::unique_ptr<SamplerFactory> make_sampler_factory(SamplerKind kind, const LoadedScene& scene,
                                                     const SamplerOptions& options);

} // namespace haarlight::renderer
