#pragma once
// Transfer and the light it is applied to as arrays of texels: of each pixel a list of squares with
// their coefficients, breadth first, and the light's coefficients by square. No GL here;
// relight.glsl reads what is made here.
//
// Squares count as in <wavelet/product/multiply.h>, so that a coarser level's come
// first. A texel's first three numbers are the differences d1, d2, d3 of a square: R, G, B as
// signed numbers of ten bits, red lowest, in a unit of that texel. The fourth is of transfer:
// square << 8 | e, the unit being 2^(e - 127); of the light: the unit as a float's bits.

#include <view/packed_scene.h>

#include <renderer/transfer/transfer.h>
#include <wavelet/product/multiply.h>
#include <wavelet/tree/tree.h>

#include <span>

namespace haarlight::view {

/// Texel i lies at (i mod 2^11, i div 2^11): rows stay within what every WebGL 2 has.
inline constexpr int texels_per_row = 1 << 11;

/// Squares of levels above this one: those that a picture of that level is made of.
constexpr int squares_above(int level) { return ((1 << (2 * level)) - 1) / 3; }

/// `transfer`, with `firsts` (of a pixel's texels there) and `pixels`: R, G, B of the mean and the
/// number of texels, or −1 where nothing is hit.
/// @param trees, points by pixel, width times height; trees of at most 12 levels
/// @throws Error(Output) if there are 2^31 nodes or more
PackedScene pack_transfer(std::span<const wavelet::TreeView> trees,
                          std::span<const renderer::FilmPoint> points, int width, int height);

/// `light_differences`, and the uniform light_mean.
PackedScene pack_coefficients(const wavelet::DenseCoefficients& light);

/// A texture of texels in rows, the last of which is filled up; or of an image's.
template <class T>
PackedTexture packed_texture(const char* sampler, Texel texel, int width, int height,
                             const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {sampler, texel, width, height, 0, false, {bytes.begin(), bytes.end()}};
}

} // namespace haarlight::view
