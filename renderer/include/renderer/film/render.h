#pragma once
// Direct illumination of a scene by its distant light.
//
// One ray goes through each pixel's centre. At the point it hits, light directions are drawn and
// ∫ f_r L v max(0, n·ω) dω is estimated; where it hits nothing the light itself is seen.

#include <renderer/film/film.h>
#include <renderer/samplers/sampler.h>
#include <renderer/scene/loaded_scene.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace haarlight::renderer {

/// What products are refined to where their own integral makes the picture, which then has no noise
/// but this error.
inline constexpr float integral_variance_bound = 0.001F;

/// How samples become radiance.
enum class Estimator {
  Unbiased,      ///< 1/N Σ f_r L v cos / p
  Bidirectional, ///< L_ns · mean(v), the paper's eq. 9: directions must follow the product. v
                 ///< counts occluders alone, whatever f_r is; directions below the horizon are left
                 ///< out
  Ratio          ///< L_ns · Σ w v / Σ w, w = f_r L cos / p (Heitz, Hill and McGuire 2018)
};

/// As on the command line: unbiased, bidirectional, ratio.
std::optional<Estimator> estimator_from_name(const std::string& name);
std::string estimator_name(Estimator estimator);

/// What is wrong with a combination, in words; nothing if it serves.
std::optional<std::string> validate(SamplerKind sampler, Estimator estimator);

/// Whether an estimator needs L_ns from a product even if the sampler has none.
inline bool needs_unshadowed(Estimator estimator) { return estimator != Estimator::Unbiased; }

struct RenderOptions {
  SamplerKind sampler = SamplerKind::Product;
  Estimator estimator = Estimator::Unbiased;
  Points points = Points::Sobol;
  int spp = 16; ///< light samples per pixel; with a time limit, of the first pass
  std::uint32_t seed = 0;
  double time_limit = 0; ///< seconds; 0 = none. Otherwise passes go on while another fits
  SamplerOptions sampling;
};

/// What rendering cost, and how well the sampler did.
struct RenderStatistics {
  double seconds = 0;         ///< wall clock of all passes
  double prepare_seconds = 0; ///< of that, summed over threads: turning samplers to points
  double thread_seconds = 0;  ///< all work, CPU time summed over threads
  std::uint64_t points = 0;   ///< prepared, over all passes
  std::uint64_t samples = 0;
  double mean_leaves = 0; ///< of products
  int spp = 0;            ///< samples per pixel in the end
  /// Mean over the hit pixels, of those with light, of N · Var / mean²: what one sample's relative
  /// variance is if points are random. Luminance.
  double relative_variance_per_sample = 0;
};

struct RenderResult {
  Film film;
  RenderStatistics statistics;
};

/// What the samplers of all threads share. Made once, it serves any number of renderings of its
/// scene with the same sampler, estimator and sampling options.
struct RenderFactories {
  /// @param scene loaded for options.sampler and the estimator; must outlive this
  /// @throws as make_sampler_factory()
  RenderFactories(const LoadedScene& scene, const RenderOptions& options);

  std::unique_ptr<SamplerFactory> sampler;
  std::unique_ptr<SamplerFactory> integrator; ///< of L_ns, where the sampler has none
};

/// Called with the share of the work that is done, in [0, 1]; from any thread.
using RenderProgress = std::function<void(double)>;

/// The film's bytes depend on scene and options alone, unless there is a time limit.
/// @param scene loaded for options.sampler and the estimator
/// @param width,height of the film in pixels
RenderResult render(const LoadedScene& scene, const RenderOptions& options, int width, int height,
                    const RenderProgress& progress = {});
/// The same with factories made before.
RenderResult render(const LoadedScene& scene, const RenderFactories& factories,
                    const RenderOptions& options, int width, int height,
                    const RenderProgress& progress = {});

} // namespace haarlight::renderer
