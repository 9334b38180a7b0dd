#include <info/page.h>

#include <info/figures.h>
#include <info/lobe_section.h>
#include <info/tables.h>
#include <info/worst_maps.h>

#include <html/frame.h>
#include <html/text.h>

#include <wavelet/file/input_file.h>
#include <wavelet/file/provenance.h>

namespace haarlight::info {
namespace {

using tool::Report;

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

/// Without the path, which the title tells as far as it may.
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
  return html::framed("haarinfo " + title, body);
}

} // namespace haarlight::info
