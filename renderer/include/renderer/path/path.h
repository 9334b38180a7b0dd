#pragma once
// Global illumination by path tracing: L = L_e + L_dir + L_ind, the paper's eqs. 1–2.
//
// One path starts at a pixel's point for each of RenderOptions::spp. At its first vertex the
// distant light is sampled by the chosen sampler, prepared once for all paths of the pixel. With
// SamplerKind::Mis, and at every later vertex, which has but one sample, it is sampled by itself
// instead and by directions the path may go on in. Emitters (spheres that stay spheres, disks,
// boxes) are sampled as well as met by the path; whatever two techniques can find counts by the
// balance heuristic (Veach and Guibas 1995). Paths go on by the reflectance, from the third vertex
// on by Russian roulette. With a sampler that is unbiased the result is.

#include <renderer/film/render.h>

namespace haarlight::renderer {

struct PathOptions {
  int depth = 0; ///< surface points on a path that are lit, at most; 1 = direct light only, 0 = any
                 ///< number
  int light_samples = 1; ///< samples of light at the first vertex for each path, above 0
};

/// What the scene must be loaded with for paths, besides what the sampler needs: of SamplerNeed.
inline constexpr unsigned path_needs = NeedsLightDistribution | NeedsLobes;

/// Renders as render() does; the estimator is Unbiased whatever the options say. `samples` are
/// paths, pdf_sum is that of the sampler's directions at the first vertex, and `variance` that of
/// whole paths.
/// @param scene loaded for options.sampler and path_needs
RenderResult render_paths(const LoadedScene& scene, const RenderFactories& factories,
                          const RenderOptions& options, const PathOptions& path, int width,
                          int height, const RenderProgress& progress = {});
/// The same with factories of its own.
RenderResult render_paths(const LoadedScene& scene, const RenderOptions& options,
                          const PathOptions& path, int width, int height,
                          const RenderProgress& progress = {});

} // namespace haarlight::renderer
