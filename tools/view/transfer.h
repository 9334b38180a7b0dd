#pragma once
// Transfer and the light it is applied to as textures. Nothing here calls GL; relight.glsl reads
// them.
//
// Of each pixel a list of squares with their coefficients, breadth first, and the light's
// coefficients by square. Squares are numbered as in <wavelet/product/multiply.h>, so
// that those of a coarser level come first. The first three numbers of a texel are the differences
// d1, d2, d3 of a square: R, G, B as signed ten-bit integers, red in the lowest bits, in a unit of
// that texel. The fourth number holds, for transfer, square << 8 | e with the unit 2^(e - 127); for
// the light, the bits of the unit as a float.

#include <view/packing.h>

#include <renderer/transfer/relight.h>
#include <wavelet/product/multiply.h>

#include <span>
#include <vector>

namespace haarlight::view {

/// Texel i lies at (i mod 2^11, i div 2^11): rows stay within what every WebGL 2 supports.
inline constexpr int texels_per_row = 1 << 11;

/// Number of squares coarser than a level: those that a picture of that level is made of.
constexpr int squares_above(int level) { return ((1 << (2 * level)) - 1) / 3; }

/// Textures `transfer`, `firsts` (the first texel of each pixel's list there) and `pixels`: R, G, B
/// of the mean and the length of the list, or −1 where no object is hit.
/// @param trees, points by pixel, width · height; trees of at most 12 levels
/// @throws Error(Output) for 2^31 nodes or more
ShaderInputs pack_transfer(std::span<const wavelet::TreeView> trees,
                           std::span<const renderer::FilmPoint> points, int width, int height);

/// Texture `light_differences` and uniform light_mean.
ShaderInputs pack_light_coefficients(const wavelet::DenseCoefficients& light);

/// The light of a transfer at any rotation.
class TransferLight {
public:
  /// @param points of the film, by pixel; must outlive this
  /// @throws Error(Input) if the light's files cannot be read
  TransferLight(const renderer::Transfer& transfer, const renderer::SceneDescription& scene,
                const std::vector<renderer::FilmPoint>& points);

  /// What relight.glsl reads of the light rotated about the world's origin: its coefficients, and
  /// `background`, the radiance of the light in the pixels where no object is hit.
  ShaderInputs rotated(const Eigen::Matrix3f& rotation) const;

private:
  TextureData background(const Eigen::Matrix3f& rotation) const;

  int m_width;
  int m_height;
  bool m_visible; ///< where no object is hit
  renderer::Light m_light;
  renderer::RotatedLight m_map;
  const std::vector<renderer::FilmPoint>& m_points;
};

} // namespace haarlight::view
