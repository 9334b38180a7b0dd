#include <support/inspect.h>

#include <support/words.h>

#include <wavelet/base/parallel.h>

#include <algorithm>
#include <cmath>

namespace haarlight::tool {
namespace {

using wavelet::Details;
using wavelet::Map;
using wavelet::MapPlace;
using wavelet::TreeSet;
using wavelet::TreeView;

double weighted_square(Float4 c) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) { // in double, which holds the square of every float
    const auto value = static_cast<double>(c[i]);
    sum += static_cast<double>(luminance_weights[i]) * value * value;
  }
  return sum;
}

LevelFigures measure_level(const TreeView& tree, std::uint32_t begin, std::uint32_t count,
                           int level) {
  LevelFigures result;
  result.nodes = count;
  for (std::uint32_t node = begin; node < begin + count; ++node) {
    const Details details = tree.details(node);
    for (const Float4 d : {details.d1, details.d2, details.d3}) {
      result.nonzero += wavelet::to_rgb(d).isZero(0) ? 0 : 1;
      result.energy += weighted_square(d);
    }
  }
  result.energy = std::ldexp(result.energy, -2 * level);
  return result;
}

void measure_masses(const TreeView& tree, int level, TreeFigures& figures) {
  const Map map = tree.reconstruct(level);
  for (std::size_t i = 0; i < map.rgb.size(); i += 3) {
    const auto value = static_cast<double>(luminance(Eigen::Map<const Rgb>(map.rgb.data() + i)));
    figures.mass += std::abs(value);
    figures.negative_mass += std::max(0.0, -value);
  }
  const double pixels = static_cast<double>(map.size) * map.size;
  figures.mass /= pixels;
  figures.negative_mass /= pixels;
}

TreeFigures measure_tree(const TreeSet& set, MapPlace index, int level) {
  const TreeView& tree = set.tree(index.column, index.row);
  TreeFigures figures;
  figures.index = index;
  figures.nodes = tree.node_count;
  figures.bytes = set.tree_bytes(index.column, index.row);
  figures.mean = tree.mean;
  figures.energy = weighted_square(wavelet::to_lanes(tree.mean));
  std::uint32_t begin = 0;
  for (int l = 0; l < set.levels(); ++l) {
    const std::uint32_t count = set.level_nodes(index.column, index.row, l);
    figures.levels.push_back(measure_level(tree, begin, count, l));
    figures.energy += figures.levels.back().energy;
    begin += count;
  }
  measure_masses(tree, level, figures);
  return figures;
}

} // namespace

std::vector<MapPlace> all_trees(const TreeSet& set) {
  std::vector<MapPlace> trees;
  for (int row = 0; row < set.info().rows; ++row)
    for (int column = 0; column < set.info().columns; ++column)
      trees.push_back({column, row});
  return trees;
}

std::vector<TreeFigures> measure_trees(const TreeSet& set, const std::vector<MapPlace>& trees,
                                       int level) {
  std::vector<TreeFigures> figures(trees.size());
  parallel_for(trees.size(),
               [&](std::size_t i) { figures[i] = measure_tree(set, trees[i], level); });
  return figures;
}

namespace {

std::string colour_text(Float4 c) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text.append(",").append(exact_text(c[i]));
  return text;
}

/// A node's square at its level.
struct Square {
  std::uint32_t x;
  std::uint32_t y;
};

constexpr std::size_t chunk_bytes = std::size_t{1} << 16;

/// Nodes lie breadth first, so that children come in the order in which their parents do.
void dump_tree(const TreeSet& set, MapPlace index,
               const std::function<void(const std::string&)>& sink) {
  const TreeView& tree = set.tree(index.column, index.row);
  const std::string start = std::to_string(index.column) + ',' + std::to_string(index.row) + ',';
  std::vector<Square> squares(std::min(tree.node_count, 1U), Square{0, 0});
  std::string lines;
  std::uint32_t node = 0;
  for (int level = 0; level < set.levels(); ++level)
    for (std::uint32_t left = set.level_nodes(index.column, index.row, level); left > 0; --left) {
      const Square square = squares[node];
      const Details details = tree.details(node);
      const std::string place = start + std::to_string(level) + ',' + std::to_string(square.x) +
                                ',' + std::to_string(square.y) + ',';
      lines.append(place).append("1").append(colour_text(details.d1)).append("\n");
      lines.append(place).append("2").append(colour_text(details.d2)).append("\n");
      lines.append(place).append("3").append(colour_text(details.d3)).append("\n");
      for (std::uint32_t q = 0; q < 4; ++q)
        if (((tree.links[node] >> q) & 1U) != 0)
          squares.push_back({2 * square.x + (q & 1U), 2 * square.y + (q >> 1U)});
      ++node;
      if (lines.size() > chunk_bytes) {
        sink(lines);
        lines.clear();
      }
    }
  sink(lines);
}

} // namespace

void dump_csv(const TreeSet& set, const std::vector<MapPlace>& trees,
              const std::function<void(const std::string&)>& sink) {
  sink("column,row,level,x,y,type,r,g,b\n");
  for (const MapPlace index : trees)
    dump_tree(set, index, sink);
}

} // namespace haarlight::tool
