#include <html/plot.h>

#include <html/axis.h>
#include <html/svg.h>
#include <html/text.h>

#include <algorithm>
#include <cmath>

namespace haarlight::html {
namespace {

constexpr double width = 560;
constexpr double height = 380;
constexpr double left = 62;
constexpr double right = 448; ///< beyond lie the labels
constexpr double top = 34;
constexpr double bottom = 330;
constexpr double label_height = 13;

std::string grid(const Axis& x, const Axis& y, const std::vector<double>& ticks) {
  std::string svg;
  for (const double value : ticks) {
    svg += line(x.place(value), top, x.place(value), bottom, "#e4e4e4");
    svg += text_at(x.place(value), bottom + 16, "text-anchor=\"middle\"", x.tick_text(value));
  }
  for (const double value : y.ticks()) {
    svg += line(left, y.place(value), right, y.place(value), "#e4e4e4");
    svg += text_at(left - 7, y.place(value) + 4, "text-anchor=\"end\"", y.tick_text(value));
  }
  return svg + line(left, bottom, right, bottom, "#777") + line(left, top, left, bottom, "#777");
}

std::string curve(const Series& series, const Axis& x, const Axis& y) {
  std::string path;
  std::string markers;
  for (const auto& [a, b] : series.points) {
    path += point(path.empty() ? 'M' : 'L', x.place(a), y.place(b));
    markers += marker_svg(series.look, x.place(a), y.place(b));
  }
  return "<path d=\"" + path + "\" fill=\"none\" stroke-width=\"1.8\" stroke=\"" +
         series.look.colour + "\"" + (series.look.dashed ? " stroke-dasharray=\"6 4\"" : "") +
         "/>" + markers + "\n";
}

/// Heights moved apart so that labels of `label_height` do not overlap, in place.
void spread(std::vector<double>& heights) {
  for (std::size_t i = 1; i < heights.size(); ++i)
    heights[i] = std::max(heights[i], heights[i - 1] + label_height);
  double limit = bottom - 6;
  for (std::size_t i = heights.size(); i-- > 0; limit -= label_height)
    heights[i] = std::min(heights[i], limit);
}

std::string labels(std::vector<Series> series, const Axis& x, const Axis& y) {
  std::sort(series.begin(), series.end(), [](const Series& a, const Series& b) {
    return a.points.back().second > b.points.back().second;
  });
  std::vector<double> heights;
  heights.reserve(series.size());
  for (const Series& one : series)
    heights.push_back(y.place(one.points.back().second));
  spread(heights);
  std::string svg;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (series[i].label.empty())
      continue;
    const auto& [end_x, end_y] = series[i].points.back();
    svg += "<path d=\"" + point('M', x.place(end_x) + 6, y.place(end_y)) +
           point('L', right + 12, heights[i]) + "\" stroke=\"" + series[i].look.colour +
           "\" stroke-width=\"0.6\" opacity=\"0.6\"/>";
    svg += text_at(right + 15, heights[i] + 4, "fill=\"" + series[i].look.colour + "\"",
                   escaped(series[i].label));
  }
  return svg;
}

std::string drawn(const std::vector<Series>& series, const PlotText& text,
                  const std::vector<double>& ticks, AxisScale scale) {
  std::vector<Series> shown;
  Axis x{.scale = scale, .from = left, .to = right};
  Axis y{.from = bottom, .to = top};
  for (Series one : series) {
    std::erase_if(one.points,
                  [&](const auto& p) { return !x.can_show(p.first) || !y.can_show(p.second); });
    for (const auto& [a, b] : one.points) {
      x.take(a);
      y.take(b);
    }
    if (!one.points.empty())
      shown.push_back(std::move(one));
  }
  x.finish();
  y.finish();
  std::string svg = svg_head(width, height);
  svg += text_at(left, 18, "font-weight=\"600\" font-size=\"14\"", escaped(text.title));
  svg += text_at((left + right) / 2, height - 12, "text-anchor=\"middle\"", escaped(text.x));
  svg += "<text transform=\"translate(14 " + fixed((top + bottom) / 2) +
         ") rotate(-90)\" text-anchor=\"middle\">" + escaped(text.y) + "</text>\n";
  svg += grid(x, y, ticks.empty() ? x.ticks() : ticks);
  for (auto one = shown.rbegin(); one != shown.rend(); ++one)
    svg += curve(*one, x, y);
  return svg + labels(shown, x, y) + "</svg>\n";
}

} // namespace

std::string log_plot(const std::vector<Series>& series, const PlotText& text,
                     const std::vector<double>& ticks) {
  return drawn(series, text, ticks, AxisScale::Logarithmic);
}

std::string angle_plot(const std::vector<Series>& series, const PlotText& text,
                       const std::vector<double>& ticks) {
  return drawn(series, text, ticks, AxisScale::Linear);
}

} // namespace haarlight::html
