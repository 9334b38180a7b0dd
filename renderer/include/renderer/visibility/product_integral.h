#pragma once
// Direct illumination without sampling: the integral of light, reflectance and the visibilities of
// all objects as a product of n + 2 functions (the paper's eqs. 10-13), all in the light's frame.
//
// The resolution is that of the visibilities. Light and reflectance keep all their detail, since a
// mirror-like lobe is narrower than the squares of an affordable visibility. An adaptive product of
// light and reflectance selects the squares; below these, the trees of light and visibilities are
// multiplied exactly. The result is multiplied by the reflectance itself, averaged over points of
// each square, which is split further where these differ. The main remaining error is light that
// varies within finest squares crossed by a visibility's edge; it decreases with the resolution.
// See renderer/PRODUCT_INTEGRAL.md.

#include <renderer/film/render.h>

namespace haarlight::renderer {

struct ProductIntegralOptions {
  /// Visibility trees have finest squares of side 2^-levels; 1 … 12.
  int levels = 7;
  /// Pixels along the side of the map from which the light's tree is built, a power of two ≥ 4, if
  /// there is a probe; no detail is dropped.
  int light_size = 2048;
  /// Bound on the estimated relative variance of the reflectance within squares, and on their
  /// number.
  wavelet::AdaptiveOptions product = {0.0005F, 65536, 0};
  /// Squares are split while the reflectance's range times light exceeds this fraction of the
  /// integral.
  float split_fraction = 1e-3F;
};

/// Data that the scene must be loaded with: of SamplerNeed.
inline constexpr unsigned product_integral_needs = NeedsLightTree | NeedsMaterialTrees;

/// Renders every pixel by its product integral. `samples` is 1 where a surface is hit; `pdf_sum`
/// and `variance` are 0. The film's bytes depend only on scene and options.
/// @param scene loaded for product_integral_needs
/// @param width,height of the film in pixels
RenderResult render_product_integral(const LoadedScene& scene,
                                     const ProductIntegralOptions& options, int width, int height,
                                     const RenderProgress& progress = {});

} // namespace haarlight::renderer
