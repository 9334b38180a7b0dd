#pragma once
// Scenes, trees and lights as textures and uniforms, in formats that OpenGL ES 3.0 and WebGL 2
// have. Nothing here calls GL.
//
// Trees. Each tree is one column, as in a θ_r-only set; the sets of several materials lie side by
// side. Averages up to dense_level are stored densely in a 3D texture whose third axis is the
// column, so that the texture unit interpolates between neighbouring columns. Below dense_level the
// shader follows the nodes' links as in a .haar file. punctual.glsl reads them:
//   coarse_averages  RGBA16F, 3D, slice_width × slice_height × columns, times coarse_unit: the
//                    squares of dense_level at (0, 0), those of each coarser level l at
//                    (dense_side, dense_side − 2^(l+1))
//   subtree_roots    R32UI, dense_side² × columns: the node at the square y·dense_side + x of
//                    dense_level plus 1, or 0 for none
//   scales           R32F, columns × 1: coefficients times this are differences
//   links            R32UI, node i at (i mod nodes_per_row, i div nodes_per_row): index of the
//   first
//                    child << 4 | child mask, counting through all columns
//   coefficients     RGBA16F, 3 nodes_per_row wide: d1, d2, d3 of each node side by side
//
// Lobes. Reflectance averaged over squares of all levels, filtered between neighbours. Each tree is
// one slice. Lobes lie about the mirror direction, the middle of the square: of levels beyond
// full_level only a window in the middle is kept, a quarter of the area of the window before. The
// levels lie below each other, each with a border of one texel from across the octahedral seam.
// environment.glsl reads them:
//   lobes            RGBA16F, 3D, lobe_width × lobe_row(lobe_levels + 1) × columns, times lobe_unit
//                    in sr⁻¹. R, G, B: average over a square; A: standard deviation of luminance
//
// Light. Averages of a distant light over the squares of all levels, as mip levels:
//   light_squares    RGBA16F. R, G, B times light_unit: average radiance, W m⁻² sr⁻¹; A: spread of
//                    the light about its mean direction, root mean square, radians
//   light_directions RGBA16F. Unit mean direction of the square's light, weighted by luminance

#include <view/view_scene.h>

#include <wavelet/tree/map_set.h>
#include <wavelet/tree/tree.h>

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace haarlight::view {

enum class TexelFormat { R32F, Rgba32F, Rgba16F, R32Ui, Rgba32Ui };
inline constexpr std::size_t texel_format_count =
    static_cast<std::size_t>(TexelFormat::Rgba32Ui) + 1;

struct TextureData {
  std::string sampler; ///< its name in the shaders
  TexelFormat format = TexelFormat::R32F;
  int width = 1;
  int height = 1;
  int depth = 0;                ///< 0: 2D, read with texelFetch(); else 3D, filtered
  bool mips = false;            ///< 2D, square: all mip levels, the finest first
  std::vector<std::byte> bytes; ///< row by row; empty if undefined
};

/// What shaders read.
struct ShaderInputs {
  std::vector<TextureData> textures;
  std::vector<std::pair<std::string, std::vector<float>>> floats; ///< uniforms of 1 to 4 floats
  std::vector<std::pair<std::string, int>> integers;
};

template <class T>
TextureData texture_data(const char* sampler, TexelFormat format, int width, int height,
                         const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {sampler, format, width, height, 0, false, {bytes.begin(), bytes.end()}};
}

/// The unit in which `largest` is 32768, half of the largest half float, so that rounding stays in
/// range; 1 for 0.
inline float half_unit(float largest) { return largest > 0 ? largest / 32768 : 1; }

inline constexpr int dense_level = 5;
inline constexpr int dense_side = 1 << dense_level;
inline constexpr int slice_width = dense_side + dense_side / 2;
inline constexpr int slice_height = dense_side;
/// Three texels for each node: rows stay within the 2048 texels that every WebGL 2 supports.
inline constexpr int nodes_per_row = 512;

/// The largest magnitude among the channels of the three differences.
float largest_detail(const wavelet::Details& details);

/// Half-float coefficients exactly, float coefficients rounded to halves of a scale of their tree.
/// @throws Error(Output) for 2^28 nodes or more
ShaderInputs pack_trees(std::span<const wavelet::TreeView> trees);

inline constexpr int full_level = 5;
inline constexpr int window_side = 1 << full_level;
inline constexpr int lobe_width = window_side + 2;
/// Finer detail of a reflectance is averaged.
inline constexpr int finest_lobe_level = 10;

/// The first row of a level; of the level after the last: the height of a slice.
constexpr int lobe_row(int level) {
  return level < full_level ? (1 << level) - 1 + 2 * level
                            : window_side - 1 + 2 * full_level + lobe_width * (level - full_level);
}

/// @param sets the trees of each material, θ_r-only
ShaderInputs pack_lobes(std::span<const std::span<const wavelet::TreeView>> sets);

/// Spread of light that is uniform over the square of level 0, radians; each level halves it.
inline constexpr float uniform_spread = 1.4472025F; // √(4π/6)

struct PackedLight {
  int levels = 0; ///< the finest squares have a side of 2^-levels
  ShaderInputs inputs;
};

/// @param map of a light in its own frame, never negative
PackedLight pack_light(const wavelet::Map& map);

/// The trees, and the shapes: `objects`, RGBA32F, two texels for each as scene.glsl reads them.
/// @throws as pack_trees()
ShaderInputs pack_scene(const ViewScene& scene);

/// The lobes of all materials, for environments.
ShaderInputs pack_lobes(const ViewScene& scene);

} // namespace haarlight::view
