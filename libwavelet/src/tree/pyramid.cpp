#include <wavelet/tree/pyramid.h>

#include <wavelet/base/parallel.h>

#include <cassert>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// One level of averages of a function: R, G, B and the mean square of luminance.
struct Level {
  int side = 0;
  float unit = 1; ///< a power of two that the function is divided by, so that squares stay in range
  std::vector<Float4> moments;

  /// The square at (x, y); coordinates one step outside wrap around the octahedron: across an edge
  /// lies the same edge, mirrored.
  Float4 at(int x, int y) const {
    if (x < 0 || x >= side) {
      x = x < 0 ? -1 - x : 2 * side - 1 - x;
      y = side - 1 - y;
    }
    if (y < 0 || y >= side) {
      y = y < 0 ? -1 - y : 2 * side - 1 - y;
      x = side - 1 - x;
    }
    x = std::clamp(x, 0, side - 1);
    y = std::clamp(y, 0, side - 1);
    return moments[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                   static_cast<std::size_t>(x)];
  }
};

/// The power of two next below the largest absolute value; 1 for a function that is 0.
float unit_of(const Map& map) {
  float largest = 0;
  for (const float value : map.rgb)
    largest = std::max(largest, std::abs(value));
  return largest > 0 ? power_of_two(std::max(std::ilogb(largest), -126)) : 1.0F;
}

Level finest_level(const TreeView& tree) {
  const Map map = tree.reconstruct(tree.levels);
  Level level = {map.size, unit_of(map), {}};
  level.moments.resize(map.rgb.size() / 3);
  for (std::size_t i = 0; i < level.moments.size(); ++i) {
    const Rgb c = Eigen::Map<const Rgb>(map.rgb.data() + 3 * i) / level.unit;
    const float y = luminance(c);
    level.moments[i] = Float4{c[0], c[1], c[2], y * y};
  }
  return level;
}

Level coarser(const Level& fine) {
  Level level = {fine.side / 2, fine.unit, {}};
  level.moments.resize(fine.moments.size() / 4);
  for (int y = 0; y < level.side; ++y)
    for (int x = 0; x < level.side; ++x)
      level.moments[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.side) +
                    static_cast<std::size_t>(x)] =
          0.25F * ((fine.at(2 * x, 2 * y) + fine.at(2 * x + 1, 2 * y)) +
                   (fine.at(2 * x, 2 * y + 1) + fine.at(2 * x + 1, 2 * y + 1)));
  return level;
}

std::vector<Level> all_levels(const TreeView& tree) {
  std::vector<Level> levels(static_cast<std::size_t>(tree.levels) + 1);
  levels.back() = finest_level(tree);
  for (std::size_t l = levels.size() - 1; l > 0; --l)
    levels[l - 1] = coarser(levels[l]);
  return levels;
}

/// Upper half of a float, rounded to nearest.
std::uint16_t upper_half(float value) {
  return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0x8000U) >> 16U);
}

Float4 with_deviation(Float4 moments) {
  const float mean = luminance(to_rgb(moments));
  moments[3] = std::sqrt(std::max(0.0F, moments[3] - mean * mean));
  return moments;
}

/// Marks, per level, the squares that have a node: their children differ from them.
void mark_nodes(const TreeView& tree, std::uint32_t node, int level, int x, int y,
                std::vector<std::vector<std::uint8_t>>& marks) {
  if (node == no_node)
    return;
  marks[static_cast<std::size_t>(level)]
       [(static_cast<std::size_t>(y) << level) + static_cast<std::size_t>(x)] = 1;
  for (unsigned q = 0; q < 4; ++q)
    mark_nodes(tree, tree.child(node, q), level + 1, 2 * x + static_cast<int>(q & 1U),
               2 * y + static_cast<int>(q >> 1U), marks);
}

std::vector<std::vector<std::uint8_t>> node_marks(const TreeView& tree) {
  std::vector<std::vector<std::uint8_t>> marks(static_cast<std::size_t>(tree.levels));
  for (std::size_t l = 0; l < marks.size(); ++l)
    marks[l].resize(std::size_t{1} << (2 * l));
  mark_nodes(tree, tree.root(), 0, 0, 0, marks);
  return marks;
}

/// Whether any square one level up, under the tile at (tx, ty) of `side` squares, has a node.
bool any_node(const std::vector<std::uint8_t>& marks, int parent_level, int tx, int ty, int side) {
  for (int y = ty * side; y < (ty + 1) * side; ++y)
    for (int x = tx * side; x < (tx + 1) * side; ++x)
      if (marks[(static_cast<std::size_t>(y) << parent_level) + static_cast<std::size_t>(x)] != 0)
        return true;
  return false;
}

} // namespace

/// The tiles of one tree, numbered from 0; joined to the others' afterwards.
struct Pyramid::EntryTiles {
  std::vector<std::uint32_t> pages;
  std::vector<std::uint16_t> texels;

  void append_tile(const Level& level, int tx, int ty) {
    for (int y = -1; y <= tile_side; ++y)
      for (int x = -1; x <= tile_side; ++x) {
        const int column = std::min(tx * tile_side + x, level.side);
        const int row = std::min(ty * tile_side + y, level.side);
        const Float4 value = with_deviation(level.at(column, row)) * level.unit;
        for (int c = 0; c < 4; ++c)
          texels.push_back(upper_half(value[c]));
      }
  }
};

Pyramid::EntryTiles Pyramid::make_tiles(const TreeView& tree) const {
  const std::vector<Level> levels = all_levels(tree);
  const auto marks = node_marks(tree);
  EntryTiles result;
  result.pages.resize(m_pages_per_entry);
  for (int l = 0; l <= m_levels; ++l) {
    const int tiles = 1 << tiles_log(l);
    std::uint32_t* page = result.pages.data() + first_page(l);
    for (int ty = 0; ty < tiles; ++ty)
      for (int tx = 0; tx < tiles; ++tx, ++page) {
        if (l <= tile_bits ||
            any_node(marks[static_cast<std::size_t>(l) - 1], l - 1, tx, ty, tile_side / 2)) {
          *page = static_cast<std::uint32_t>(result.texels.size() / tile_values);
          result.append_tile(levels[static_cast<std::size_t>(l)], tx, ty);
          continue;
        }
        const int log = tiles_log(l - 1);
        const std::uint32_t parent =
            result.pages[first_page(l - 1) +
                         static_cast<std::size_t>(((ty >> (tiles_log(l) - log)) << log) +
                                                  (tx >> (tiles_log(l) - log)))];
        *page = (parent & absent) != 0 ? parent : absent | static_cast<std::uint32_t>(l - 1);
      }
  }
  return result;
}

Pyramid::Pyramid(std::span<const TreeView> trees)
    : m_entries(static_cast<int>(trees.size())), m_levels(trees.empty() ? 0 : trees[0].levels) {
  for (int l = 0; l <= m_levels; ++l) {
    m_grids.push_back({power_of_two(l), static_cast<float>((1 << tiles_log(l)) - 1),
                       static_cast<float>(m_pages_per_entry)});
    m_pages_per_entry += std::size_t{1} << (2 * tiles_log(l));
  }
  std::vector<EntryTiles> tiles(trees.size());
  parallel_for(trees.size(), [&](std::size_t i) {
    assert(trees[i].levels == m_levels);
    tiles[i] = make_tiles(trees[i]);
  });
  std::size_t total = 0;
  for (const EntryTiles& entry : tiles)
    total += entry.texels.size();
  m_texels.reserve(total);
  m_pages.reserve(m_pages_per_entry * trees.size());
  for (EntryTiles& entry : tiles) {
    const auto first = static_cast<std::uint32_t>(m_texels.size() / tile_values);
    for (const std::uint32_t page : entry.pages)
      m_pages.push_back((page & absent) != 0 ? page : page + first);
    m_texels.insert(m_texels.end(), entry.texels.begin(), entry.texels.end());
    entry = {};
  }
}

/// At the finest level at or above the place's own that has a tile there.
Float4 Pyramid::lookup_coarser(const std::uint32_t* pages, const Places& p, std::size_t i) const {
  const std::uint32_t page = pages[p.page[i]];
  if ((page & absent) == 0) {
    detail::Texels upper;
    detail::Texels lower;
    detail::load_texels(texels(page, p.texel[i]), upper);
    detail::load_texels(texels(page, p.texel[i]) + 4 * stored_side, lower);
    return detail::blend_texels(upper + (lower - upper) * p.fy[i], p.fx[i]);
  }
  Places coarser;
  coarser.u[0] = p.u[i];
  coarser.v[0] = p.v[i];
  set_level(coarser, 0, static_cast<int>(page & 15U));
  place(coarser, 1);
  return lookup_coarser(pages, coarser, 0);
}

Float4 Pyramid::lookup(int entry, int level, float u, float v) const {
  Places p;
  p.u[0] = u;
  p.v[0] = v;
  set_level(p, 0, level);
  place(p, 1);
  return lookup_coarser(pages(entry), p, 0);
}

} // namespace haarlight::wavelet
