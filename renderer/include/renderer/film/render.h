#pragma once
// Direct illumination of a scene by its distant light.
//
// One ray is traced through each pixel's centre. At its hit, light directions are sampled to
// estimate ∫ f_r L v max(0, n·ω) dω; pixels without a hit show the light itself.

#include <renderer/film/film.h>
#include <renderer/samplers/sampler.h>
#include <renderer/scene/loaded_scene.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace haarlight::renderer {

/// The variance bound of products whose integral is used as a pixel's value.
inline constexpr float integral_variance_bound = 0.001F;

/// Estimators of radiance from samples.
enum class Estimator {
  Unbiased,      ///< 1/N Σ f_r L v cos / p
  Bidirectional, ///< L_ns · mean(v), the paper's eq. 9: directions must follow the product. Only
                 ///< directions above the horizon count, including those with f_r = 0
  Ratio          ///< L_ns · Σ w v / Σ w, w = f_r L cos / p (Heitz, Hill and McGuire 2018)
};

/// As on the command line: unbiased, bidirectional, ratio.
std::optional<Estimator> estimator_from_name(const std::string& name);
std::string estimator_name(Estimator estimator);

/// An error message for a combination that is not supported, or nothing.
std::optional<std::string> validate(SamplerKind sampler, Estimator estimator);

/// Whether an estimator needs L_ns, from a product if the sampler has none.
inline bool needs_unshadowed(Estimator estimator) { return estimator != Estimator::Unbiased; }

struct RenderOptions {
  SamplerKind sampler = SamplerKind::Product;
  Estimator estimator = Estimator::Unbiased;
  Points points = Points::Sobol;
  int spp = 16; ///< light samples per pixel; of the first pass if there is a time limit
  std::uint32_t seed = 0;
  double time_limit = 0; ///< seconds; 0 = none. Passes are added while another one fits
  SamplerOptions sampling;
};

/// Cost of a rendering and efficiency of the sampler.
struct RenderStatistics {
  double seconds = 0;         ///< wall clock of all passes
  double prepare_seconds = 0; ///< wall clock of preparing samplers, summed over threads
  double thread_seconds = 0;  ///< CPU time summed over threads
  std::uint64_t points = 0;   ///< shading points prepared, over all passes
  std::uint64_t samples = 0;
  double mean_leaves = 0; ///< of products
  int spp = 0;            ///< samples per pixel, total
  /// Mean over all hit pixels that are not black of N · Var / mean² of luminance: the relative
  /// variance of one sample if points are random.
  double relative_variance_per_sample = 0;
};

struct RenderResult {
  Film film;
  RenderStatistics statistics;
};

/// Data shared by the samplers of all threads; reusable for any number of renderings of a scene
/// with the same sampler, estimator and sampling options.
struct RenderFactories {
  /// @param scene loaded for options.sampler and the estimator; must outlive this
  /// @throws as make_sampler_factory()
  RenderFactories(const LoadedScene& scene, const RenderOptions& options);

  std::unique_ptr<SamplerFactory> sampler;
  std::unique_ptr<SamplerFactory> integrator; ///< computes L_ns, where the sampler does not
};

/// Called with the completed fraction of the work, in [0, 1]; from any thread.
using RenderProgress = std::function<void(double)>;

/// Renders a film. Its bytes depend only on scene and options, unless there is a time limit.
/// @param scene loaded for options.sampler and the estimator
/// @param width,height of the film in pixels
RenderResult render(const LoadedScene& scene, const RenderOptions& options, int width, int height,
                    const RenderProgress& progress = {});
/// The same with existing factories.
RenderResult render(const LoadedScene& scene, const RenderFactories& factories,
                    const RenderOptions& options, int width, int height,
                    const RenderProgress& progress = {});

} // namespace haarlight::renderer
