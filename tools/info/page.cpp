#include <info/page.h>

#include <html/page.h>
#include <html/plot.h>

#include <image/png.h>

#include <wavelet/file/input_file.h>
#include <wavelet/file/provenance.h>

#include <algorithm>
#include <cmath>

namespace haarlight::info {
namespace {

using tool::Report;

std::string value_html(double number) { return html::number_html(number); }
std::string value_html(std::int64_t number) { return std::to_string(number); }
std::string value_html(bool value) { return value ? "yes" : "no"; }
std::string value_html(const std::string& text) { return html::escaped(text); }
std::string value_html(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers)
    text.append(text.empty() ? "" : ", ").append(html::number_html(number));
  return text;
}

std::string value_html(const Report::Entry& entry) {
  const std::string value = std::visit([](const auto& v) { return value_html(v); }, entry.value);
  return entry.unit.empty() ? value : value + " " + html::escaped(entry.unit);
}

html::Cell cell_of(const Report::Entry& entry, const std::string& html) {
  const bool is_text = std::holds_alternative<std::string>(entry.value);
  return {html, is_text ? html::Cell::Style::Text : html::Cell::Style::Number};
}

/// An entry's name with blanks.
std::string name_html(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return html::escaped(name);
}

/// A list of rows as a table.
std::string rows_html(const std::vector<Report>& reports) {
  html::TableRow head;
  for (const Report::Entry& entry : reports.front().entries())
    head.push_back(cell_of(entry, name_html(entry.name)));
  std::vector<html::TableRow> rows;
  for (const Report& report : reports) {
    rows.emplace_back();
    for (const Report::Entry& entry : report.entries())
      rows.back().push_back(cell_of(entry, value_html(entry)));
  }
  return html::table({head}, rows);
}

/// The single values of a report, one row each; sections and lists are left out.
std::string values_html(const Report& report) {
  std::vector<html::TableRow> rows;
  for (const Report::Entry& entry : report.entries())
    if (entry.form == Report::Entry::Form::Value)
      rows.push_back({{name_html(entry.name)}, {value_html(entry)}});
  return html::value_table(rows);
}

/// A section or a list of a report by name; empty if there is none.
std::string part_html(const Report& report, const std::string& name) {
  for (const Report::Entry& entry : report.entries())
    if (entry.name == name && !entry.parts.empty())
      return entry.form == Report::Entry::Form::Rows ? rows_html(entry.parts)
                                                     : values_html(entry.parts.front());
  return {};
}

constexpr int largest_side = 1024;

int picture_level(const wavelet::TreeSet& set, bool single, std::optional<int> level) {
  if (!single)
    return std::min(level.value_or(set.levels()), tool::atlas_level(set, largest_side));
  return std::min(level.value_or(set.levels()), static_cast<int>(std::log2(largest_side)));
}

std::string picture_html(Image picture, const std::string& alternative) {
  const std::string width = std::to_string(std::max(picture.width, 256));
  image::brighten(picture, image::middle_grey_gain(picture));
  return "<img class=\"wide\" width=\"" + width + "\" alt=\"" + alternative + "\" src=\"" +
         html::png_uri(picture, {.tone_map = image::ToneMap::Filmic}) + "\">\n";
}

/// All maps side by side, or the one map if there is one.
std::string atlas_html(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& trees,
                       std::optional<int> level) {
  const bool single = trees.size() == 1;
  const int shown = picture_level(set, single, level);
  const std::string pixels = std::to_string(1 << shown);
  if (single)
    return "<h2>The map</h2>\n<p>At " + pixels +
           " px, scaled to a mean of 0.18 and tone mapped.</p>\n" +
           picture_html(tool::tree_picture(set.tree(trees[0].column, trees[0].row), shown), "map");
  return "<h2>All maps</h2>\n<p>Each at " + pixels +
         " px; columns are arranged to the right and rows downwards; a single row is wrapped to a "
         "square. "
         "Scaled to a mean of 0.18 and tone mapped.</p>\n" +
         picture_html(tool::atlas(set, shown), "all maps");
}

/// Bars of coefficients and of energy by level.
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
                        {"Nonzero coefficients, and the largest possible number", "level",
                         "coefficients (RGB triples)"},
                        "#4363d8") +
         html::bar_plot(energies,
                        {"Energy of the coefficients", "level", "fraction of the total energy"},
                        "#2ca02c") +
         "</div>\n";
}

std::string error_curve_html(const wavelet::TreeSet& set,
                             const std::vector<wavelet::MapPlace>& trees) {
  html::Series series{
      .label = {}, .style = {.colour = "#d4002a", .marker = html::no_marker}, .points = {}};
  for (const KeptPoint& point : error_curve(set, trees))
    series.points.emplace_back(static_cast<double>(point.kept), point.error);
  return "<h2>Error by coefficients kept</h2>\n<p>Relative L2 error of these trees if only a "
         "number "
         "of their coefficients were kept, those with the largest L2 norm of all trees; averages "
         "are always kept. The point of error 0, where all are kept, is not shown.</p>\n<div "
         "class=\"plots\">" +
         html::log_plot({series}, {"Error by coefficients kept", "coefficients kept (RGB triples)",
                                   "relative L2 error"}) +
         "</div>\n";
}

std::string title_of(const PageInput& input) {
  std::string title = base_name(input.path);
  if (!input.tree.empty())
    title.append("[")
        .append(std::to_string(static_cast<int>(input.tree[0])))
        .append(",")
        .append(std::to_string(static_cast<int>(input.tree[1])))
        .append("]");
  return title;
}

/// Without the path: the page must not depend on the folder.
std::string header_html(const Report& header) {
  Report shown;
  for (const Report::Entry& entry : header.entries())
    if (entry.form == Report::Entry::Form::Value && entry.name != "file")
      std::visit([&](const auto& value) { shown.add(entry.name, value, entry.unit); }, entry.value);
  return "<h2>The file</h2>\n" + values_html(shown) + "<h2>Provenance</h2>\n" +
         part_html(header, "provenance");
}

std::string levels_html(const std::vector<tool::TreeFigures>& figures, int levels) {
  Report report;
  tool::describe_figures(figures, levels, false, report);
  return "<h2>Coefficients</h2>\n" + values_html(report) + "<h3>By level</h3>\n" +
         part_html(report, "levels") +
         level_bars_html(tool::sum_of(figures, levels), figures.size()) +
         (figures.size() > 1 ? "<h3>Smallest and largest tree</h3>\n" : "") +
         (figures.size() > 1 ? part_html(report, "size_per_tree") : "");
}

} // namespace

std::string page_html(const wavelet::TreeSet& set, const PageInput& input,
                      const std::vector<wavelet::MapPlace>& trees,
                      const std::vector<tool::TreeFigures>& figures) {
  const std::string title = title_of(input);
  std::string body =
      "<h1>" + html::escaped(title) + "</h1>\n<p>" + html::escaped(version_text()) + "</p>\n";
  body += atlas_html(set, trees, input.level) + levels_html(figures, set.levels()) +
          error_curve_html(set, trees);
  if (!input.reference.empty())
    body += worst_maps_html({input.reference, input.path, input.tree, {}});
  body += lobes_html(set, trees) + header_html(tool::describe_header(set, input.form));
  return html::report_page("haarinfo " + title, body);
}

} // namespace haarlight::info
