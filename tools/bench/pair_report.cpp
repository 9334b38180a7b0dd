#include <bench/report.h>

#include <html/page.h>

#include <image/false_colour.h>
#include <image/png.h>

#include <algorithm>
#include <cmath>

namespace haarlight::bench {

using namespace html;

namespace {

/// The part of the film that is shown.
struct Crop {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

constexpr int largest_shown_side = 128;

Image cropped(const Image& picture, const Crop& crop) {
  Image result(crop.width, crop.height);
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x)
      result.set(x, y, picture.at(crop.x + x, crop.y + y));
  return result;
}

float signed_root(float value) { return std::copysign(std::sqrt(std::abs(value)), value); }

bool hit(const PairResult& pair, int x, int y) { return pair.hit[pair.reference.offset(x, y) / 3]; }

/// 1 % of the mean luminance of the pixels that hit an object.
float floor_of(const PairResult& pair) {
  double sum = 0;
  double count = 0;
  for (int y = 0; y < pair.reference.height; ++y)
    for (int x = 0; x < pair.reference.width; ++x)
      if (hit(pair, x, y)) {
        sum += static_cast<double>(luminance(pair.reference.at(x, y)));
        ++count;
      }
  return static_cast<float>(0.01 * sum / std::max(1.0, count));
}

Crop crop_of(const Image& picture) {
  const int width = std::min(largest_shown_side, picture.width);
  const int height = std::min(largest_shown_side, picture.height);
  return {(picture.width - width) / 2, (picture.height - height) / 2, width, height};
}

/// Rows of one sampler, kind of points and mode; of both modes if `mode` is empty.
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
    Series spp{name, style_of(kind), {}};
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

Cell ratio_cell(const Row& row) {
  const bool significant = std::abs(row.mean_ratio - 1) > 4 * row.mean_ratio_stderr;
  return {ratio_html(row.mean_ratio) + " ± " + ratio_html(row.mean_ratio_stderr),
          significant ? Cell::Style::Outlier : Cell::Style::Number};
}

/// @param samples, time the rows of one sampler at equal samples and at equal time
TableRow sampler_row(const Row& samples, const Row& time) {
  const auto number = [](double value) { return number_cell(number_html(value)); };
  return {{sampler_html(samples.sampler)},
          number_cell(number_html(samples.relmse) + " ± " + number_html(samples.relmse_stderr)),
          number(samples.relvar_per_sample),
          ratio_cell(samples),
          number(samples.slope),
          number(1e9 * samples.seconds_per_sample),
          number(1e6 * samples.seconds_per_point),
          number(samples.setup_seconds),
          number(samples.precompute_seconds),
          number_cell(std::to_string(time.spp)),
          number(time.seconds),
          number(time.relmse),
          ratio_cell(time),
          number(time.efficiency)};
}

std::string samplers_table(const Plan& plan, const PairResult& pair, const std::string& points) {
  TableRow head = {{"sampler"}};
  for (const char* name : {"relMSE", "variance of a sample", "mean ÷ reference", "slope",
                           "ns per sample", "µs per pixel", "set-up s", "trees s", "spp", "s",
                           "relMSE", "mean ÷ reference", "1/(relMSE·s)"})
    head.push_back(number_cell(name));
  TableRow groups;
  std::vector<TableRow> rows;
  for (const renderer::SamplerKind kind : plan.samplers) {
    const std::string name = renderer::sampler_name(kind);
    const Row& samples = *rows_of(pair, name, points, "equal-samples").back();
    const Row& time = *rows_of(pair, name, points, "equal-time").back();
    if (groups.empty())
      groups = {{""},
                group_cell("equal samples, " + std::to_string(samples.spp) + " spp", 4),
                group_cell("cost", 4),
                group_cell("equal time, " + number_html(time.budget_seconds) + " s", 5)};
    rows.push_back(sampler_row(samples, time));
  }
  return table({groups, head}, rows);
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

html::PlotStyle style_of(renderer::SamplerKind kind) {
  const auto index = static_cast<std::size_t>(kind);
  return {series_colour(index), static_cast<int>(index) % marker_count,
          renderer::traits(kind).bias == renderer::Bias::Biased};
}

std::string sampler_html(const std::string& name) {
  const auto kind = renderer::sampler_from_name(name);
  if (!kind)
    return escaped(name);
  const PlotStyle style = style_of(*kind);
  return swatch_svg(style) + escaped(name) +
         (style.dashed ? " <span class=\"tag\">biased</span>" : "");
}

std::string picture_uri(const PairResult& pair, const Image& picture) {
  const Crop crop = crop_of(pair.reference);
  const float gain = image::middle_grey_gain(cropped(pair.reference, crop));
  return png_uri(cropped(picture, crop),
                 {std::log2(static_cast<double>(gain)), image::ToneMap::Filmic});
}

std::string error_uri(const PairResult& pair, const Image& picture) {
  const Crop crop = crop_of(pair.reference);
  const float floor = floor_of(pair);
  Image map(crop.width, crop.height);
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x) {
      const float expected = luminance(pair.reference.at(crop.x + x, crop.y + y));
      const float error = luminance(picture.at(crop.x + x, crop.y + y)) - expected;
      const float scale = std::max(std::hypot(expected, floor), 1e-30F);
      map.set(x, y,
              hit(pair, crop.x + x, crop.y + y)
                  ? image::false_colour(std::clamp(signed_root(error / scale), -1.0F, 1.0F))
                  : Rgb::Ones());
    }
  return png_uri(map);
}

std::string legend_uri() {
  Image bar(201, 1);
  for (int x = 0; x < bar.width; ++x)
    bar.set(x, 0, image::false_colour(static_cast<float>(x - 100) / 100));
  return png_uri(bar);
}

std::string pair_html(const Plan& plan, const PairResult& pair) {
  std::string html = "<section>\n<h2>" + escaped(pair.brdf) + " × " + escaped(pair.probe) +
                     "<small> on " + escaped(pair.scene) + "</small></h2>\n";
  for (const renderer::Points points : plan.points) {
    const std::string name = points == renderer::Points::Sobol ? "sobol" : "random";
    if (plan.points.size() > 1)
      html += "<h3>" + name + " points</h3>\n";
    html += plots(plan, pair, name) + samplers_table(plan, pair, name);
  }
  return html + "<h3>Pictures at equal time, of the smallest budget</h3>\n" + pictures(pair) +
         "</section>\n";
}

} // namespace haarlight::bench
