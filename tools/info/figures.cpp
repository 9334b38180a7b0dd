#include <info/figures.h>

#include <info/error_curve.h>

#include <html/bars.h>
#include <html/plot.h>
#include <html/png_uri.h>
#include <html/text.h>

#include <image/png.h>

#include <algorithm>
#include <cmath>

namespace haarlight::info {
namespace {

constexpr int largest_side = 1024;

int level_of(const wavelet::TreeSet& set, bool single, std::optional<int> level) {
  if (!single)
    return std::min(level.value_or(set.levels()), tool::atlas_level(set, largest_side));
  return std::min(level.value_or(set.levels()), static_cast<int>(std::log2(largest_side)));
}

std::string image_html(Image picture, const std::string& alternative) {
  const std::string width = std::to_string(std::max(picture.width, 256));
  image::brighten(picture, image::middle_grey_gain(picture));
  return "<img class=\"wide\" width=\"" + width + "\" alt=\"" + alternative + "\" src=\"" +
         html::png_uri(picture, {.tone_map = image::ToneMap::Filmic}) + "\">\n";
}

} // namespace

std::string atlas_html(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& trees,
                       std::optional<int> level) {
  const bool single = trees.size() == 1;
  const int shown = level_of(set, single, level);
  const std::string pixels = std::to_string(1 << shown);
  if (single)
    return "<h2>The map</h2>\n<p>At " + pixels +
           " px, scaled to a mean of 0.18 and tone mapped.</p>\n" +
           image_html(tool::tree_picture(set.tree(trees[0].column, trees[0].row), shown), "map");
  return "<h2>All maps</h2>\n<p>Each at " + pixels +
         " px; columns run to the right and rows down, or a single row is folded to a square. "
         "Scaled to a mean of 0.18 and tone mapped.</p>\n" +
         image_html(tool::atlas(set, shown), "all maps");
}

std::string level_bars_html(const tool::TreeFigures& sum, std::size_t trees) {
  std::vector<html::Bar> counts;
  std::vector<html::Bar> energies;
  for (std::size_t l = 0; l < sum.levels.size(); ++l) {
    const std::string label = std::to_string(l);
    const double possible =
        static_cast<double>(3 * trees) * std::ldexp(1.0, 2 * static_cast<int>(l));
    counts.push_back({label, static_cast<double>(sum.levels[l].nonzero), possible});
    energies.push_back({label, tool::fraction(sum.levels[l].energy, sum.energy), 0});
  }
  return "<div class=\"plots\">" +
         html::bar_plot(counts,
                        {"Coefficients that are not zero, and all that could be", "level",
                         "coefficients (RGB triples)"},
                        "#4363d8") +
         html::bar_plot(energies, {"Energy of the wavelets", "level", "share of all energy"},
                        "#2ca02c") +
         "</div>\n";
}

std::string error_curve_html(const wavelet::TreeSet& set,
                             const std::vector<wavelet::MapPlace>& trees) {
  html::Series series{
      .label = {}, .look = {.colour = "#d4002a", .marker = html::no_marker}, .points = {}};
  for (const KeptPoint& point : error_curve(set, trees))
    series.points.emplace_back(static_cast<double>(point.kept), point.error);
  return "<h2>Kept against error</h2>\n<p>What would be left of these trees if only so many of "
         "their coefficients were kept, the largest by L2 of all trees together; the averages "
         "always stay. The error is the L2 of what is left out over the L2 of all, and falls to "
         "nothing when all are kept, which has no place here.</p>\n<div class=\"plots\">" +
         html::log_plot({series}, {"Error by coefficients kept", "coefficients kept (RGB triples)",
                                   "relative L2 error"}) +
         "</div>\n";
}

} // namespace haarlight::info
