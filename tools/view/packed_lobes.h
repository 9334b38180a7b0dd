#pragma once
// Reflectances as averages over squares of all levels, filtered between neighbours by the texture
// unit. No GL here.
//
// Every tree is one slice. Lobes lie about the mirror direction, which is the middle of the square:
// of levels beyond `full_level` only a window in the middle is kept, which is a quarter of the one
// before. Levels lie below each other, all with one more texel around them, from across the
// octahedral seams where the square ends.

#include <wavelet/tree/tree.h>

#include <cstdint>
#include <span>
#include <vector>

namespace haarlight::view {

inline constexpr int full_level = 5;
inline constexpr int window_side = 1 << full_level;
inline constexpr int lobe_width = window_side + 2;
/// Finer detail than this of a reflectance is averaged.
inline constexpr int finest_lobe_level = 10;

/// The first row of a level; of the one beyond the last: the height of a slice.
constexpr int lobe_row(int level) {
  return level < full_level ? (1 << level) - 1 + 2 * level
                            : window_side - 1 + 2 * full_level + lobe_width * (level - full_level);
}

struct PackedLobes {
  int levels = 0; ///< of the finest squares
  int columns = 0;
  float unit = 1;                    ///< texels times this are sr⁻¹
  std::vector<std::uint16_t> texels; ///< RGBA16F, lobe_width × lobe_row(levels + 1) × columns. R,
                                     ///< G, B: average over a square; A: standard deviation of
                                     ///< luminance within it
};

/// @param sets the trees of each material, θ_r-only, one after the other
PackedLobes pack_lobes(std::span<const std::span<const wavelet::TreeView>> sets);

} // namespace haarlight::view
