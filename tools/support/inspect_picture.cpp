#include <support/inspect.h>

#include <wavelet/base/parallel.h>

#include <algorithm>

namespace haarlight::tool {
namespace {

using wavelet::TreeSet;

struct Grid {
  int columns;
  int rows;
};

Grid grid_of(const TreeSet& set) {
  const wavelet::SetInfo& info = set.info();
  if (info.rows > 1)
    return {info.columns, info.rows};
  int columns = 1;
  while (columns * columns < info.columns)
    ++columns;
  return {columns, (info.columns + columns - 1) / columns};
}

} // namespace

Image tree_picture(const wavelet::TreeView& tree, int level) {
  wavelet::Map map = tree.reconstruct(level);
  Image picture;
  picture.width = picture.height = map.size;
  picture.rgb = std::move(map.rgb);
  return picture;
}

std::int64_t atlas_side(const TreeSet& set, int level) {
  const Grid grid = grid_of(set);
  return std::int64_t{std::max(grid.columns, grid.rows)} << level;
}

int atlas_level(const TreeSet& set, std::int64_t largest_side) {
  int level = set.levels();
  while (level > 0 && atlas_side(set, level) > largest_side)
    --level;
  return level;
}

Image atlas(const TreeSet& set, int level) {
  const Grid grid = grid_of(set);
  const int side = 1 << level;
  const std::vector<wavelet::MapPlace> trees = all_trees(set);
  Image picture(grid.columns * side, grid.rows * side);
  parallel_for(trees.size(), [&](std::size_t i) {
    const wavelet::Map map = set.tree(trees[i].column, trees[i].row).reconstruct(level);
    const int left = static_cast<int>(i) % grid.columns * side;
    const int top = static_cast<int>(i) / grid.columns * side;
    for (int y = 0; y < side; ++y)
      std::copy_n(map.rgb.data() + map.offset(0, y), 3 * static_cast<std::size_t>(side),
                  picture.rgb.data() + picture.offset(left, top + y));
  });
  return picture;
}

} // namespace haarlight::tool
