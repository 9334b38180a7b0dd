#pragma once
// Averages over squares of any level, looked up in constant time.
//
// A tree gives the average over a square by descent; an adaptive product asks for hundreds of them
// per shading point, each at an arbitrary place and level, in two neighbouring trees. The pyramid
// holds them ready: per tree and level a grid of averages, cut into tiles of 8 × 8 squares that
// exist only where the tree has wavelets, interpolated bilinearly between square centres and across
// the octahedral seams.

#include <wavelet/base/lanes.h>
#include <wavelet/tree/tree.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Read-only and safe to share between threads once built. Values are rounded to 8 bits of
/// mantissa: sufficient for a sampling density, which need not be exact, and for integrals to a few
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

  /// Points, each at its own level, and their positions in the grids.
  struct Places {
    static constexpr int capacity = 64;
    float u[capacity], v[capacity]; ///< in [0, 1]
    float scale[capacity];          ///< squares a side, set with the next two by set_level()
    float last_tile[capacity];
    float first_page[capacity];
    std::int32_t page[capacity], texel[capacity]; ///< set with the next by place()
    float fx[capacity], fy[capacity];
  };

  /// @param level 0 …; beyond levels() it counts as levels()
  void set_level(Places& places, std::size_t i, int level) const;

  /// Computes the positions of the first `count` points, whose levels and u, v are set.
  static void place(Places& places, int count);

  /// lookup() at a place in two entries: (1 − blend) · first + blend · second.
  Float4 lookup(int first, int second, float blend, const Places& places, std::size_t i) const;

private:
  static constexpr int tile_bits = 3;
  static constexpr int tile_side = 1 << tile_bits;
  static constexpr int stored_side = tile_side + 2; ///< with one square of each neighbour
  static constexpr std::size_t tile_values = 4ULL * stored_side * stored_side;
  static constexpr std::uint32_t absent = 0x80000000U; ///< low bits: the finest level that exists

  const std::uint32_t* pages(int entry) const {
    return m_pages.data() + static_cast<std::size_t>(entry) * m_pages_per_entry;
  }
  const std::uint16_t* texels(std::uint32_t page, std::int32_t texel) const {
    return m_texels.data() + page * tile_values + texel;
  }
  Float4 lookup_coarser(const std::uint32_t* pages, const Places& places, std::size_t i) const;

  static int tiles_log(int level) { return std::max(level - tile_bits, 0); }

  struct EntryTiles;
  EntryTiles make_tiles(const TreeView& tree) const;

  int m_entries;
  int m_levels;
  /// The tiles of a level: squares a side, last tile of a row, first page.
  struct Grid {
    float scale, last_tile, first_page;
  };

  std::size_t first_page(int level) const {
    return static_cast<std::size_t>(m_grids[static_cast<std::size_t>(level)].first_page);
  }

  std::vector<Grid> m_grids; ///< by level
  std::size_t m_pages_per_entry = 0;
  std::vector<std::uint32_t> m_pages;  ///< tile index, or absent | level
  std::vector<std::uint16_t> m_texels; ///< upper halves of floats, R, G, B, deviation
};

namespace detail {

/// Two neighbouring texels of four channels.
using Texels = float __attribute__((vector_size(32)));

inline void load_texels(const std::uint16_t* from, Texels& texels) {
  using Short8 = std::uint16_t __attribute__((vector_size(16)));
  using Word8 = std::uint32_t __attribute__((vector_size(32)));
  Short8 raw;
  std::memcpy(&raw, from, sizeof raw);
  const Word8 wide = __builtin_convertvector(raw, Word8) << 16U;
  std::memcpy(&texels, &wide, sizeof texels);
}

/// (1 − f)·first + f·second.
inline Float4 blend_texels(const Texels& texels, float f) {
  const Float4 first = __builtin_shufflevector(texels, texels, 0, 1, 2, 3);
  const Float4 second = __builtin_shufflevector(texels, texels, 4, 5, 6, 7);
  return first + (second - first) * f;
}

} // namespace detail

inline void Pyramid::set_level(Places& p, std::size_t i, int level) const {
  const Grid& grid = m_grids[static_cast<std::size_t>(std::min(level, m_levels))];
  p.scale[i] = grid.scale;
  p.last_tile[i] = grid.last_tile;
  p.first_page[i] = grid.first_page;
}

/// All in floats, which are exact here: not every CPU has vectors of integer products.
inline void Pyramid::place(Places& p, int count) {
  constexpr float side = tile_side;
  for (int i = 0; i < count; ++i) {
    const float x = p.u[i] * p.scale[i] + 0.5F;
    const float y = p.v[i] * p.scale[i] + 0.5F;
    const auto ix = static_cast<float>(static_cast<std::int32_t>(x));
    const auto iy = static_cast<float>(static_cast<std::int32_t>(y));
    const float last = p.last_tile[i];
    const float tx = smaller(static_cast<float>(static_cast<std::int32_t>(ix / side)), last);
    const float ty = smaller(static_cast<float>(static_cast<std::int32_t>(iy / side)), last);
    p.page[i] = static_cast<std::int32_t>(ty * (last + 1) + tx + p.first_page[i]);
    p.texel[i] = static_cast<std::int32_t>(4 * (stored_side * (iy - ty * side) + (ix - tx * side)));
    p.fx[i] = x - ix;
    p.fy[i] = y - iy;
  }
}

inline Float4 Pyramid::lookup(int first, int second, float blend, const Places& p,
                              std::size_t i) const {
  const std::uint32_t page0 = pages(first)[p.page[i]];
  const std::uint32_t page1 = pages(second)[p.page[i]];
  if (((page0 | page1) & absent) != 0) {
    const Float4 near = lookup_coarser(pages(first), p, i);
    return near + (lookup_coarser(pages(second), p, i) - near) * blend;
  }
  const std::uint16_t* near = texels(page0, p.texel[i]);
  const std::uint16_t* far = texels(page1, p.texel[i]);
  detail::Texels upper;
  detail::Texels lower;
  detail::Texels far_upper;
  detail::Texels far_lower;
  detail::load_texels(near, upper);
  detail::load_texels(near + 4 * stored_side, lower);
  detail::load_texels(far, far_upper);
  detail::load_texels(far + 4 * stored_side, far_lower);
  upper += (far_upper - upper) * blend;
  lower += (far_lower - lower) * blend;
  return detail::blend_texels(upper + (lower - upper) * p.fy[i], p.fx[i]);
}

} // namespace haarlight::wavelet
