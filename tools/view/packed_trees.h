#pragma once
// Trees as arrays of texels, in formats that WebGL 2 and OpenGL ES 3.0 have. No GL here.
//
// Every tree is one column, as in a θ_r-only set; several sets lie side by side. The coarse levels
// are dense, so that the texture unit can filter between neighbouring columns; below them nodes are
// found by links, as in a .haar file. trees.glsl reads what is made here.

#include <wavelet/tree/tree.h>

#include <cstdint>
#include <span>
#include <vector>

namespace haarlight::view {

/// The level up to which averages are dense.
inline constexpr int top_level = 5;
inline constexpr int top_side = 1 << top_level;

/// A column's averages of all dense levels lie in one slice of this size: the square of top_level
/// at (0, 0), that of each coarser level l at (top_side, top_side − 2^(l+1)).
inline constexpr int slice_width = top_side + top_side / 2;
inline constexpr int slice_height = top_side;

/// Node i lies at (i mod nodes_per_row, i div nodes_per_row); its three coefficient texels side by
/// side. Rows stay within the 2048 texels that every WebGL 2 has.
inline constexpr int nodes_per_row = 512;

struct PackedTrees {
  int columns = 0;
  int node_rows = 0;
  std::uint32_t nodes = 0;

  std::vector<std::uint16_t> tops;   ///< RGBA16F, slice_width × slice_height × columns
  float top_unit = 1;                ///< texels of `tops` times this are averages
  std::vector<std::uint32_t> starts; ///< R32UI, top_side² × columns: the node at the square
                                     ///< y·top_side + x of top_level plus 1, or 0 for none
  std::vector<float> scales;        ///< R32F, columns × 1: coefficients times this are differences
  std::vector<std::uint32_t> links; ///< R32UI, nodes_per_row × node_rows: index of the first child
                                    ///< << 4 | child mask, counting through all columns
  std::vector<std::uint16_t> coefficients; ///< RGBA16F, 3 nodes_per_row × node_rows: d1, d2, d3

  std::size_t bytes() const;
};

/// @param trees of all columns, with fewer than 2^28 nodes in all
/// @return halves exactly, floats rounded to halves of a scale of their tree
PackedTrees pack_trees(std::span<const wavelet::TreeView> trees);

} // namespace haarlight::view
