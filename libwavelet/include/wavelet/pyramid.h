#pragma once
// Averages over squares of any level, looked up in constant time.
//
// A tree gives the average over a square by descent; an adaptive product asks for hundreds of them
// per shading point, each at an arbitrary place and level, in two neighbouring trees. The pyramid
// holds them ready: per tree and level a grid of averages, cut into tiles of 8 × 8 squares that
// exist only where the tree has wavelets, interpolated bilinearly between square centres and across
// the octahedral seams.

#include <wavelet/lanes.h>
#include <wavelet/tree.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Read-only and safe to share between threads once built. Values are rounded to 8 bits of
/// mantissa: good for a sampling density, which is exact whatever it is, and for integrals to a few
/// 0.1 %.
class Pyramid {
public:
  /// @param trees of one set: same number of levels
  explicit Pyramid(std::span<const TreeView> trees);

  int entries() const { return m_entries; }

  /// Finest level: squares of side 2^-levels().
  int levels() const { return m_levels; }

  std::size_t bytes() const { return m_texels.size() * 2 + m_pages.size() * 4; }

  /// Lanes R, G, B: the average over a square of side 2^-level centred on (u, v). Lane 3: the
  /// standard deviation of luminance within such a square.
  /// @param level 0 … levels(); @param u,v in [0, 1]
  Float4 lookup(int entry, int level, float u, float v) const;

  /// Where four points lie in the grids of a level, for look-ups of them in several entries.
  struct Places {
    int level;
    Float4 u, v;
    Int4 page, texel;
    Float4 fx, fy;
  };
  Places places(int level, Float4 u, Float4 v) const;

  /// lookup() of one of four places.
  Float4 lookup(int entry, const Places& places, int lane) const;

private:
  static constexpr int tile_bits = 3;
  static constexpr int tile_side = 1 << tile_bits;
  static constexpr int stored_side = tile_side + 2; ///< with one square of each neighbour
  static constexpr std::size_t tile_values = 4ULL * stored_side * stored_side;
  static constexpr std::uint32_t absent = 0x80000000U; ///< low bits: the finest level that exists

  Float4 interpolate(std::uint32_t page, int texel, float fx, float fy) const;

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

inline Pyramid::Places Pyramid::places(int level, Float4 u, Float4 v) const {
  const float scale = power_of_two(level);
  const Float4 x = u * scale + 0.5F;
  const Float4 y = v * scale + 0.5F;
  const Int4 ix = __builtin_convertvector(x, Int4);
  const Int4 iy = __builtin_convertvector(y, Int4);
  const int log = tiles_log(level);
  const Int4 last = Int4{} + ((1 << log) - 1);
  const Int4 tile_x = ix >> tile_bits;
  const Int4 tile_y = iy >> tile_bits;
  const Int4 tx = tile_x < last ? tile_x : last;
  const Int4 ty = tile_y < last ? tile_y : last;
  Places result;
  result.level = level;
  result.u = u;
  result.v = v;
  result.page =
      (ty << log) + tx + static_cast<int>(m_level_offset[static_cast<std::size_t>(level)]);
  result.texel = 4 * (stored_side * (iy - (ty << tile_bits)) + ix - (tx << tile_bits));
  result.fx = x - __builtin_convertvector(ix, Float4);
  result.fy = y - __builtin_convertvector(iy, Float4);
  return result;
}

inline Float4 Pyramid::interpolate(std::uint32_t page, int texel, float fx, float fy) const {
  const std::uint16_t* p = m_texels.data() + page * tile_values + texel;
  const Float4 upper = detail::blend_texels(p, fx);
  const Float4 lower = detail::blend_texels(p + 4 * stored_side, fx);
  return upper + (lower - upper) * fy;
}

inline Float4 Pyramid::lookup(int entry, const Places& p, int lane) const {
  const std::uint32_t page = m_pages[static_cast<std::size_t>(entry) * m_pages_per_entry +
                                     static_cast<std::size_t>(p.page[lane])];
  if ((page & absent) != 0)
    return lookup(entry, static_cast<int>(page & 15U), p.u[lane], p.v[lane]);
  return interpolate(page, p.texel[lane], p.fx[lane], p.fy[lane]);
}

} // namespace haarlight::wavelet
