#pragma once
// The framework of all integrators: one ray through each pixel's centre, tiles, threads, and passes
// up to the time limit. A PixelShader computes the light reflected at a hit.

#include <renderer/film/render.h>

#include <array>
#include <functional>
#include <memory>

namespace haarlight::renderer {
/// Sums over one technique's samples (luminance), which are independent and identically distributed
/// if points are random.
struct TechniqueSums {
  std::uint32_t count = 0;
  double shadowed = 0;        ///< Σ w v
  double unshadowed = 0;      ///< Σ w
  double shadowed_square = 0; ///< Σ w² v
  double square = 0;          ///< Σ w²

  void add(const TechniqueSums& other);
};

/// w = f_r L cos / p is a sample's unshadowed contribution, v ∈ {0, 1} its visibility.
struct PixelSums {
  Rgb shadowed = Rgb::Zero();   ///< Σ w v
  Rgb unshadowed = Rgb::Zero(); ///< Σ w
  Rgb emitted = Rgb::Zero();    ///< by the visible surface; added to every estimate
  Rgb product = Rgb::Zero();    ///< L_ns of the product, as of the last pass
  std::array<TechniqueSums, random_techniques> techniques;
  SumVariance shared; ///< of Σ w v and Σ w, in excess of that of independent samples
  double pdf = 0;     ///< Σ p
  std::uint32_t count = 0;
  std::uint32_t directions = 0; ///< above the horizon, for the bidirectional estimator
  std::uint32_t visible = 0;    ///< of those, unoccluded

  void add(const Rgb& weight, bool v, float p, Technique technique);

  /// Adds a direction above the horizon, for the bidirectional estimator.
  void add_direction(bool v);

  /// Adds Sampler::shared_variance() of a pass.
  void add_shared(const SumVariance& variance);
};

/// A pixel's radiance.
Rgb estimate(const PixelSums& sums, Estimator estimator);

/// Estimated variance of its luminance; 0 with fewer than two samples. If a technique has a single
/// sample, all samples are treated as draws from one mixture, which adds the variance between the
/// techniques' means.
double estimate_variance(const PixelSums& sums, Estimator estimator);

/// A range of samples of every pixel.
struct Pass {
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

/// Accumulated cost of shading.
struct ShadingCost {
  double prepare_seconds = 0;
  std::uint64_t points = 0;
  std::uint64_t leaves = 0;
};

/// The hit of a pixel's ray.
struct PixelHit {
  Hit hit; ///< its normal on the viewer's side
  Vec3 wo; ///< unit direction to the viewer, world
  std::uint32_t pixel = 0;
};

/// Shades pixels; one per thread.
class PixelShader {
public:
  virtual ~PixelShader() = default;

  /// Clears cached state.
  virtual void reset() = 0;

  /// Adds a pass's samples of reflected light to the pixel's sums.
  virtual void shade(const PixelHit& seen, const Pass& pass, PixelSums& sums) = 0;

  /// The cost since the last call.
  ShadingCost take_cost() { return std::exchange(m_cost, {}); }

protected:
  ShadingCost m_cost;
};

/// Creates a thread's shader; called from any thread.
using MakeShader = std::function<std::unique_ptr<PixelShader>()>;

/// Renders the film. Its bytes depend only on scene, options and shader, unless there is a time
/// limit.
RenderResult render_film(const LoadedScene& scene, const RenderOptions& options,
                         const MakeShader& make, int width, int height,
                         const RenderProgress& progress);

} // namespace haarlight::renderer
