#include <bench/pair_section.h>

#include <bench/look.h>
#include <bench/pictures.h>

#include <html/cells.h>
#include <html/plot.h>
#include <html/text.h>

#include <algorithm>
#include <cmath>

namespace haarlight::bench {

using namespace html;

namespace {

/// Rows of one sampler and kind of points, of one mode; both modes if it is empty.
std::vector<const Row*> rows_of(const PairResult& pair, const std::string& sampler,
                                const std::string& points, const std::string& mode) {
  std::vector<const Row*> rows;
  for (const Row& row : pair.rows)
    if (row.sampler == sampler && row.points == points && (mode.empty() || row.mode == mode))
      rows.push_back(&row);
  return rows;
}

std::string plots(const Plan& plan, const PairResult& pair, const std::string& points) {
  std::vector<Series> by_spp;
  std::vector<Series> by_time;
  for (const renderer::SamplerKind kind : plan.samplers) {
    const std::string name = renderer::sampler_name(kind);
    Series spp{name, look_of(kind), {}};
    Series time = spp;
    for (const Row* row : rows_of(pair, name, points, "equal-samples"))
      spp.points.emplace_back(row->spp, row->relmse);
    std::vector<const Row*> both = rows_of(pair, name, points, "");
    std::stable_sort(both.begin(), both.end(),
                     [](const Row* a, const Row* b) { return a->spp < b->spp; });
    for (const Row* row : both)
      time.points.emplace_back(row->seconds, row->relmse);
    by_spp.push_back(std::move(spp));
    by_time.push_back(std::move(time));
  }
  const std::vector<double> ticks(plan.spps.begin(), plan.spps.end());
  return "<div class=\"plots\">" +
         log_plot(by_spp, {"Error by samples", "samples per pixel", "relative MSE"}, ticks) +
         log_plot(by_time, {"Error by time", "CPU seconds per film", "relative MSE"}) + "</div>\n";
}

std::string ratio_cell(const Row& row) {
  const double off = std::abs(row.mean_ratio - 1);
  const bool significant = off > 4 * row.mean_ratio_stderr;
  return std::string("<td class=\"n") + (significant ? " off" : "") + "\">" +
         ratio_html(row.mean_ratio) + " ± " + ratio_html(row.mean_ratio_stderr) + "</td>";
}

std::string sampler_line(const Row& samples, const Row& time) {
  return "<tr>" + text_cell(sampler_html(samples.sampler)) +
         figure_cell(number_html(samples.relmse) + " ± " + number_html(samples.relmse_stderr)) +
         figure_cell(number_html(samples.relvar_per_sample)) + ratio_cell(samples) +
         figure_cell(number_html(samples.slope)) +
         figure_cell(number_html(1e9 * samples.seconds_per_sample)) +
         figure_cell(number_html(1e6 * samples.seconds_per_point)) +
         figure_cell(number_html(samples.setup_seconds)) +
         figure_cell(number_html(samples.precompute_seconds)) +
         figure_cell(std::to_string(time.spp)) + figure_cell(number_html(time.seconds)) +
         figure_cell(number_html(time.relmse)) + ratio_cell(time) +
         figure_cell(number_html(time.efficiency)) + "</tr>\n";
}

std::string table_head(const Row& samples, const Row& time) {
  std::string html = "<table><thead><tr>" + text_head("") +
                     group_head("equal samples, " + std::to_string(samples.spp) + " spp", 4) +
                     group_head("cost", 4) +
                     group_head("equal time, " + number_html(time.budget_seconds) + " s", 5) +
                     "</tr><tr>" + text_head("sampler");
  for (const char* name : {"relMSE", "variance of a sample", "mean ÷ reference", "slope",
                           "ns per sample", "µs per pixel", "set-up s", "trees s", "spp", "s",
                           "relMSE", "mean ÷ reference", "1/(relMSE·s)"})
    html += figure_head(name);
  return html + "</tr></thead><tbody>\n";
}

std::string table(const Plan& plan, const PairResult& pair, const std::string& points) {
  std::string html;
  for (const renderer::SamplerKind kind : plan.samplers) {
    const std::string name = renderer::sampler_name(kind);
    const Row& samples = *rows_of(pair, name, points, "equal-samples").back();
    const Row& time = *rows_of(pair, name, points, "equal-time").back();
    if (html.empty())
      html = table_head(samples, time);
    html += sampler_line(samples, time);
  }
  return html + "</tbody></table>\n";
}

std::string figure(const PairResult& pair, const Image& picture, bool errors,
                   const std::string& caption) {
  const Crop crop = crop_of(pair.reference);
  const std::string size = "\" width=\"" + std::to_string(crop.width * 128 / crop.height) +
                           "\" height=\"128\" alt=\"\">";
  std::string html = "<figure><img src=\"" + picture_uri(pair, picture) + size;
  if (errors)
    html += "<img src=\"" + error_uri(pair, picture) + size;
  else
    html += "<div class=\"legend\"><img src=\"" + legend_uri() +
            "\" alt=\"\"><div><span>−100 %</span><span>−25</span><span>0</span><span>25</span>"
            "<span>100 %</span></div>error relative to the reference</div>";
  return html + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string pictures(const PairResult& pair) {
  std::string html =
      "<div class=\"pictures\">\n" + figure(pair, pair.reference, false, "<b>reference</b>");
  for (const Exhibit& exhibit : pair.exhibits)
    html += figure(pair, exhibit.picture, true,
                   "<b>" + escaped(renderer::sampler_name(exhibit.sampler)) + "</b><br>" +
                       std::to_string(exhibit.spp) + " spp, relMSE " + number_html(exhibit.relmse));
  return html + "</div>\n";
}

} // namespace

std::string pair_html(const Plan& plan, const PairResult& pair) {
  std::string html = "<section>\n<h2>" + escaped(pair.brdf) + " × " + escaped(pair.probe) +
                     "<small> on " + escaped(pair.scene) + "</small></h2>\n";
  for (const renderer::Points points : plan.points) {
    const std::string name = points == renderer::Points::Sobol ? "sobol" : "random";
    if (plan.points.size() > 1)
      html += "<h3>" + name + " points</h3>\n";
    html += plots(plan, pair, name) + table(plan, pair, name);
  }
  return html + "<h3>Pictures at equal time, of the smallest budget</h3>\n" + pictures(pair) +
         "</section>\n";
}

} // namespace haarlight::bench
