#pragma once
// Averages over squares of any level, looked up in constant time.
//
// A tree gives the average over a square by descent; an adaptive product asks for hundreds of them per
// shading point, each at an arbitrary place and level, in two neighbouring trees. The pyramid holds them
// ready: per tree and level a grid of averages, cut into tiles of 8 × 8 squares that exist only where the
// tree has wavelets, interpolated bilinearly between square centres and across the octahedral seams.

#include <wavelet/lanes.h>
#include <wavelet/tree.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Read-only and safe to share between threads once built. Values are rounded to 8 bits of mantissa:
/// good for a sampling density, which is exact whatever it is, and for integrals to a few 0.1 %.
class Pyramid {
public:
  /// @param trees of one set: same number of levels
  explicit Pyramid(std::span<const TreeView> trees);

  int entries() const { return m_entries; }

  /// Finest level: squares of side 2^-levels().
  int levels() const { return m_levels; }

  std::size_t bytes() const { return m_texels.size() * 2 + m_pages.size() * 4; }

  /// Lanes R, G, B: the average over a square of side 2^-level centred on (u, v). Lane 3: the standard
  /// deviation of luminance within such a square.
  /// @param level 0 … levels(); @param u,v in [0, 1]
  Float4 lookup(int entry, int level, float u, float v) const;

private:
  static constexpr int tile_bits = 3;
  static constexpr int tile_side = 1 << tile_bits;
  static constexpr int stored_side = tile_side + 2; ///< with one square of each neighbour
  static constexpr std::size_t tile_values = 4ULL * stored_side * stored_side;
  static constexpr std::uint32_t absent = 0x80000000U; ///< low bits: the finest level that exists

  static int tiles_log(int level) { return std::max(level - tile_bits, 0); }

  struct EntryTiles;
  EntryTiles make_tiles(const TreeView& tree) const;

  int m_entries;
  int m_levels;
  std::vector<std::uint32_t> m_level_offset; ///< first page of each level
  std::size_t m_pages_per_entry = 0;
  std::vector<std::uint32_t> m_pages;  ///< tile index, or absent | level
  std::vector<std::uint16_t> m_texels; ///< upper halves of floats, R, G, B, deviation
};

namespace detail {

using Short8 = std::uint16_t __attribute__((vector_size(16)));

/// Two neighbouring texels, 16 bytes, blended: (1 − f)·first + f·second.
inline Float4 blend_texels(const std::uint16_t* texels, float f) {
  Short8 raw;
  std::memcpy(&raw, texels, sizeof raw);
  const Short8 zero = {};
  const auto first =
      std::bit_cast<Float4>(__builtin_shufflevector(zero, raw, 0, 8, 1, 9, 2, 10, 3, 11));
  const auto second =
      std::bit_cast<Float4>(__builtin_shufflevector(zero, raw, 4, 12, 5, 13, 6, 14, 7, 15));
  return first + (second - first) * f;
}

} // namespace detail

inline Float4 Pyramid::lookup(int entry, int level, float u, float v) const {
  const std::uint32_t* pages = m_pages.data() + static_cast<std::size_t>(entry) * m_pages_per_entry;
  while (true) {
    const float scale = static_cast<float>(1 << level);
    const float x = u * scale + 0.5F;
    const float y = v * scale + 0.5F;
    const int ix = static_cast<int>(x);
    const int iy = static_cast<int>(y);
    const int log = tiles_log(level);
    const int tx = std::min(ix >> tile_bits, (1 << log) - 1);
    const int ty = std::min(iy >> tile_bits, (1 << log) - 1);
    const std::uint32_t page =
        pages[m_level_offset[static_cast<std::size_t>(level)] + static_cast<std::uint32_t>((ty << log) + tx)];
    if ((page & absent) != 0) {
      level = static_cast<int>(page & 15U);
      continue;
    }
    const int column = ix - (tx << tile_bits);
    const int row = iy - (ty << tile_bits);
    const std::uint16_t* texel = m_texels.data() + page * tile_values +
                                 4 * static_cast<std::size_t>(row * stored_side + column);
    const float fx = x - static_cast<float>(ix);
    const Float4 upper = detail::blend_texels(texel, fx);
    const Float4 lower = detail::blend_texels(texel + 4 * stored_side, fx);
    return upper + (lower - upper) * (y - static_cast<float>(iy));
  }
}

} // namespace haarlight::wavelet
