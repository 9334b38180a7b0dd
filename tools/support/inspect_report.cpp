#include <support/inspect.h>

#include <algorithm>
#include <cmath>

namespace haarlight::tool {
namespace {

using wavelet::TreeSet;

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
        .add("nonzero_share", share(static_cast<double>(level.nonzero), 3 * squares))
        .add("energy_share", share(level.energy, sum.energy));
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
      .add("negative_mass_share", share(tree.negative_mass, tree.mass))
      .add("mean", channels_of(tree.mean));
}

} // namespace

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
      .add("nonzero_share", share(static_cast<double>(nonzero), possible))
      .add("mean_energy", sum.energy / trees)
      .add("negative_mass_share", share(sum.negative_mass, sum.mass))
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
