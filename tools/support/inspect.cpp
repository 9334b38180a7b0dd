#include <support/inspect.h>

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

const char* kind_name(wavelet::SetKind kind) {
  switch (kind) {
  case wavelet::SetKind::Brdf:
    return "brdf";
  case wavelet::SetKind::Light:
    return "light";
  case wavelet::SetKind::Transfer:
    return "transfer";
  case wavelet::SetKind::Generic:
    break;
  }
  return "generic";
}

const char* fold_name(wavelet::Fold fold) {
  switch (fold) {
  case wavelet::Fold::Rotations:
    return "rotations";
  case wavelet::Fold::Mirrors:
    return "mirrors";
  case wavelet::Fold::None:
    break;
  }
  return "none";
}

std::vector<double> channels_of(const Rgb& c) {
  return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

void describe_levels(const TreeFigures& sum, double trees, Report& report) {
  for (std::size_t l = 0; l < sum.levels.size(); ++l) {
    const LevelFigures& level = sum.levels[l];
    const double squares = trees * std::ldexp(1.0, 2 * static_cast<int>(l));
    report.row("levels")
        .add("level", l)
        .add("nodes", level.nodes)
        .add("nonzero", level.nonzero)
        .add("nonzero_share", fraction(static_cast<double>(level.nonzero), 3 * squares))
        .add("energy_share", fraction(level.energy, sum.energy));
  }
}

void describe_size(const char* name, const TreeFigures& tree, Report& report) {
  report.row("size_per_tree")
      .add("which", name)
      .add("column", tree.index.column)
      .add("row", tree.index.row)
      .add("nodes", tree.nodes)
      .add("bytes", tree.bytes);
}

void describe_tree(const TreeFigures& tree, Report& report) {
  report.row("trees")
      .add("column", tree.index.column)
      .add("row", tree.index.row)
      .add("nodes", tree.nodes)
      .add("bytes", tree.bytes)
      .add("energy", tree.energy)
      .add("negative_mass_share", fraction(tree.negative_mass, tree.mass))
      .add("mean", channels_of(tree.mean));
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

void dump_csv(const TreeSet& set, const std::vector<MapPlace>& trees,
              const std::function<void(const std::string&)>& sink) {
  sink("column,row,level,x,y,type,r,g,b\n");
  for (const MapPlace index : trees)
    dump_tree(set, index, sink);
}

TreeFigures sum_of(const std::vector<TreeFigures>& figures, int levels) {
  TreeFigures sum;
  sum.levels.resize(static_cast<std::size_t>(levels));
  for (const TreeFigures& tree : figures) {
    sum.nodes += tree.nodes;
    sum.bytes += tree.bytes;
    sum.energy += tree.energy;
    sum.mass += tree.mass;
    sum.negative_mass += tree.negative_mass;
    for (std::size_t l = 0; l < sum.levels.size(); ++l) {
      sum.levels[l].nodes += tree.levels[l].nodes;
      sum.levels[l].nonzero += tree.levels[l].nonzero;
      sum.levels[l].energy += tree.levels[l].energy;
    }
  }
  return sum;
}

const char* form_name(wavelet::FileForm form) {
  return form == wavelet::FileForm::Packed ? "packed" : "mapped";
}

Report describe_header(const TreeSet& set, wavelet::FileForm form) {
  const wavelet::SetInfo& info = set.info();
  Report report;
  report.add("file", set.path())
      .add("form", form_name(form))
      .add("bytes", static_cast<std::uint64_t>(InputFile(set.path()).size()));
  if (form == wavelet::FileForm::Packed)
    report.add("unpacked_bytes", set.file_bytes());
  report.add("kind", kind_name(info.kind))
      .add("domain", "octahedral equal-area (Clarberg 2008)")
      .add("map_size", info.size, "px")
      .add("levels_stored", set.levels())
      .add("columns", info.columns)
      .add("rows", info.rows)
      .add("rolls", info.rolls)
      .add("fold", fold_name(info.fold))
      .add("cosine", info.cosine)
      .add("world_frame", info.world_frame)
      .add("channels", set.channels() == 1 ? "luminance" : "rgb")
      .add("coefficients", set.coefficients() == wavelet::CoefficientType::Half ? "half" : "float")
      .add("frame", info.frame)
      .add("units", info.units);
  Report& provenance = report.section("provenance");
  for (const auto& [name, value] : info.provenance.entries())
    provenance.add(name, value);
  return report;
}

void describe_figures(const std::vector<TreeFigures>& figures, int levels, bool list_trees,
                      Report& report) {
  const auto trees = static_cast<double>(figures.size());
  const TreeFigures sum = sum_of(figures, levels);
  std::uint64_t nonzero = 0;
  for (const LevelFigures& level : sum.levels)
    nonzero += level.nonzero;
  const double possible = trees * (std::ldexp(1.0, 2 * levels) - 1);
  report.add("trees_measured", figures.size())
      .add("nodes", sum.nodes)
      .add("nonzero_coefficients", nonzero)
      .add("nonzero_share", fraction(static_cast<double>(nonzero), possible))
      .add("mean_energy", sum.energy / trees)
      .add("negative_mass_share", fraction(sum.negative_mass, sum.mass))
      .add("mean_tree_bytes", static_cast<double>(sum.bytes) / trees);
  describe_levels(sum, trees, report);
  const auto smaller = [](const TreeFigures& a, const TreeFigures& b) { return a.bytes < b.bytes; };
  const auto [least, most] = std::minmax_element(figures.begin(), figures.end(), smaller);
  describe_size("smallest", *least, report);
  describe_size("largest", *most, report);
  if (list_trees)
    for (const TreeFigures& tree : figures)
      describe_tree(tree, report);
}

} // namespace haarlight::tool
