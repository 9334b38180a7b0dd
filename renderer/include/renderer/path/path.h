#pragma once
// Global illumination by path tracing: L = L_e + L_dir + L_ind, the paper's eqs. 1–2.
//
// RenderOptions::spp paths start at the point seen by a pixel. At their first vertex the distant
// light is sampled by the chosen sampler, prepared once for all paths of the pixel. With
// SamplerKind::Mis, and at all later vertices, which take one sample each, light samples and BSDF
// samples are combined instead. Emitters (spheres under similarity maps, disks, boxes) are sampled
// and also hit by paths. Combined techniques use the balance heuristic (Veach and Guibas 1995).
// Paths continue by BSDF samples, with Russian roulette from the third vertex on. The result is
// unbiased if the sampler is.

#include <renderer/film/render.h>

namespace haarlight::renderer {

struct PathOptions {
  int depth = 0; ///< maximum number of vertices whose direct light counts; 1 = direct light only,
                 ///< 0 = unlimited
  int light_samples = 1; ///< light samples at the first vertex per path, > 0
};

/// Data that paths need besides those of the sampler: of SamplerNeed.
inline constexpr unsigned path_needs = NeedsLightDistribution | NeedsLobes;

/// Renders as render() does, always with Estimator::Unbiased. In the film, `samples` counts paths,
/// `pdf_sum` sums the pdfs of the sampler's directions at the first vertex, and `variance` is that
/// of whole paths.
/// @param scene loaded for options.sampler and path_needs
RenderResult render_paths(const LoadedScene& scene, const RenderFactories& factories,
                          const RenderOptions& options, const PathOptions& path, int width,
                          int height, const RenderProgress& progress = {});
/// The same with new factories.
RenderResult render_paths(const LoadedScene& scene, const RenderOptions& options,
                          const PathOptions& path, int width, int height,
                          const RenderProgress& progress = {});

} // namespace haarlight::renderer
