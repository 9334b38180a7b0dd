#pragma once
// The interface of samplers of light directions at a shading point.

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
/// with each, so that the variance of the estimate is the sum of those of the techniques.
enum class Technique : std::uint8_t {
  First,
  Second,
  Fixed ///< the same direction for every seed
};
inline constexpr std::size_t random_techniques = 2; ///< First and Second

/// MIS weights of Technique::First in a direction; those of Second are the complements to 1.
struct FirstWeights {
  float balance = 1;   ///< of the balance heuristic, n1 p1 / (n1 p1 + n2 p2)
  float heuristic = 1; ///< of the sampler's heuristic
};

/// A direction and its density. For several techniques this is their mean density, weighted by
/// their numbers of samples, so that f/pdf is the balance heuristic; for resampled directions it is
/// the reciprocal of their weight.
struct DirectionSample {
  Vec3 direction; ///< unit, in the light's frame
  float pdf = 0;  ///< sr⁻¹; 0 = no direction could be drawn, the sample contributes 0
  Technique technique = Technique::First;
  FirstWeights first = {}; ///< for the variance if a technique drew a single sample
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
  std::uint32_t first = 0; ///< index of the first sample, > 0 in later passes

  void fill(std::uint32_t dimension, std::span<Vec2> out) const {
    fill_points(kind, hash_words(key, dimension), first, out);
  }
};

/// Samples directions at one point after another; one per thread.
class Sampler {
public:
  virtual ~Sampler() = default;

  /// Clears cached state.
  virtual void reset() {}

  /// Sets the shading point; fastest if near the previous one. Arguments must live until the next
  /// call.
  virtual void prepare(const ShadingPoint& point, const Material& material) = 0;

  /// Draws out.size() directions for the point.
  virtual void sample(const PointSource& points, std::span<DirectionSample> out) = 0;

  /// Density of sample() with `count` samples at any direction, sr⁻¹; for resampled directions,
  /// that of the candidates.
  virtual float pdf(const Vec3& direction, std::size_t count) const = 0;

  /// The radiance of the directions of the last sample(): the light's, unless they represent
  /// regions.
  virtual void radiance(const Light& light, std::span<const Vec3> directions,
                        std::span<Rgb> out) const {
    light.radiance(directions, out);
  }

  /// The point's unshadowed reflected radiance by the sampler's product, L_ns of the paper's eq. 8;
  /// none for samplers without a product.
  virtual std::optional<Rgb> unshadowed() const { return std::nullopt; }

  /// The variance of the sums in excess of that of independent samples, for the last sample():
  /// resampled directions share a pool of candidates.
  /// @param visible of each sample, not 0 if it is unoccluded
  virtual SumVariance shared_variance(std::span<const std::uint8_t> /*visible*/) const {
    return {};
  }

  /// Leaves of the current product, 0 without one.
  virtual std::size_t leaves() const { return 0; }
};

struct SamplerOptions {
  wavelet::AdaptiveOptions product = {.variance_bound = 0}; ///< a bound of 0 means
                                                            ///< default_variance_bound()
  std::size_t count = 0; ///< expected samples per pass; data that depend on it are then computed
                         ///< beforehand
  int candidates = 16;   ///< per sample of resampling samplers, at most; > 0
  int regions = 512;     ///< of the partition of two-stage, at most; ≥ 4
  int pps_samples = 128; ///< initial BRDF values of pps, ≥ 1
};

/// The default variance bound of products. The variance due to n leaves is about k/n, in addition
/// to a constant part v. If N samples take the time of r·N leaves, variance × time, (v + k/n)(r·N +
/// n), is minimal at k/n = √(k·v/(r·N)): the bound is proportional to 1/√N.
/// @param count samples drawn from one product, > 0
float default_variance_bound(std::size_t count);

/// Data shared by the samplers of all threads; creates each thread's sampler.
class SamplerFactory {
public:
  virtual ~SamplerFactory() = default;

  /// @param count expected samples per point, > 0
  virtual std::unique_ptr<Sampler> make(std::size_t count) const = 0;
};

/// @param scene loaded for this kind; must outlive the factory and its samplers
/// @throws Error(Input) if the scene lacks what the sampler needs
std::unique_ptr<SamplerFactory> make_sampler_factory(SamplerKind kind, const LoadedScene& scene,
                                                     const SamplerOptions& options);

} // namespace haarlight::renderer
