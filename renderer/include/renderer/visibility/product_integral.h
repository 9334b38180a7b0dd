#pragma once
// Direct illumination without samples: the integral of light, reflectance and the visibilities of
// all objects as a product of n + 2 functions (the paper's eqs. 10-13), all in the light's frame.
//
// The resolution is that of the visibilities. Light and reflectance are used as finely as they have
// detail, since a mirror's lobe is narrower than the squares of any affordable visibility. An
// adaptive product of the two says which squares matter; below each of them the trees of light and
// visibilities go on, and their product is exact. Only then does the reflectance come in: the
// truth, averaged over points of the square, which is split again where these differ. What is left
// of the error is that of light which varies within those finest squares of a visibility that its
// edge crosses, which falls with the resolution; and little else. renderer/PRODUCT_INTEGRAL.md has
// figures.

#include <renderer/film/render.h>

namespace haarlight::renderer {

struct ProductIntegralOptions {
  /// Visibility trees have finest squares of side 2^-levels; 1 … 12.
  int levels = 7;
  /// Pixels along the side of the map that the light's tree is made from, a power of two ≥ 4, where
  /// there is a probe; all of that map's detail is kept.
  int light_size = 2048;
  /// Relative variance of reflectance within squares, by estimate, and number of squares.
  wavelet::AdaptiveOptions product = {0.0005F, 65536, 0};
  /// Squares on which the reflectance's range times light is more than this share of the integral
  /// are split.
  float split_share = 1e-3F;
};

/// What the scene has to be loaded with: of SamplerNeed.
inline constexpr unsigned product_integral_needs = NeedsLightTree | NeedsMaterialTrees;

/// Renders every pixel by its product integral. `samples` is 1 where something is hit; `pdf_sum`
/// and `variance` are 0. The film's bytes depend on scene and options alone.
/// @param scene loaded for product_integral_needs
/// @param width,height of the film in pixels
RenderResult render_product_integral(const LoadedScene& scene,
                                     const ProductIntegralOptions& options, int width, int height,
                                     const RenderProgress& progress = {});

} // namespace haarlight::renderer
