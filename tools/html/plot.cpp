#include <html/plot.h>

#include <html/page.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace haarlight::html {
namespace {

// Layout of a plot.
constexpr double width = 560;
constexpr double height = 380;
constexpr double left = 62;
constexpr double top = 34;
constexpr double bottom = 330;
constexpr double curves_right = 448; ///< labels are to the right
constexpr double bars_right = 545;
constexpr double label_height = 13;

constexpr std::array colours = {"#d4002a", "#f58231", "#c7a200", "#2ca02c", "#111111",
                                "#4363d8", "#911eb4", "#00a5c8", "#f032e6", "#7a7a00",
                                "#9a5b1e", "#7f7f7f", "#00806b", "#8b0046", "#000088",
                                "#e377a2", "#6fae00", "#5aa0e6", "#b05cff", "#4b3621"};

/// A marker centred at (x, y).
std::string marker_svg(const PlotStyle& style, double x, double y) {
  static constexpr std::array<const char*, marker_count> shapes = {
      "m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z", "m-3.2 -3.2h6.4v6.4h-6.4z", "m0 -4l4 7h-8z",
      "m0 -4.4l4.4 4.4l-4.4 4.4l-4.4 -4.4z", "m0 4l4 -7h-8z"};
  if (style.marker == no_marker)
    return {};
  return "<path d=\"" + path_point('M', x, y) + shapes[static_cast<std::size_t>(style.marker)] +
         "\" fill=\"" + (style.dashed ? "#fff" : style.colour) + "\" stroke=\"" + style.colour +
         "\" stroke-width=\"1.5\"/>";
}

std::string curve_svg(const Series& series, const Axis& x, const Axis& y) {
  std::string path;
  std::string markers;
  for (const auto& [a, b] : series.points) {
    path += path_point(path.empty() ? 'M' : 'L', x.coordinate(a), y.coordinate(b));
    markers += marker_svg(series.style, x.coordinate(a), y.coordinate(b));
  }
  return "<path d=\"" + path + "\" fill=\"none\" stroke-width=\"1.8\" stroke=\"" +
         series.style.colour + "\"" + (series.style.dashed ? " stroke-dasharray=\"6 4\"" : "") +
         "/>" + markers + "\n";
}

/// Moves heights apart so that labels of label_height do not overlap.
void spread(std::vector<double>& heights) {
  for (std::size_t i = 1; i < heights.size(); ++i)
    heights[i] = std::max(heights[i], heights[i - 1] + label_height);
  double limit = bottom - 6;
  for (std::size_t i = heights.size(); i-- > 0; limit -= label_height)
    heights[i] = std::min(heights[i], limit);
}

/// Labels to the right of the curves, connected to their ends.
std::string labels_svg(std::vector<Series> series, const Axis& x, const Axis& y) {
  std::sort(series.begin(), series.end(), [](const Series& a, const Series& b) {
    return a.points.back().second > b.points.back().second;
  });
  std::vector<double> heights;
  heights.reserve(series.size());
  for (const Series& one : series)
    heights.push_back(y.coordinate(one.points.back().second));
  spread(heights);
  std::string svg;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (series[i].label.empty())
      continue;
    const auto& [end_x, end_y] = series[i].points.back();
    svg += "<path d=\"" + path_point('M', x.coordinate(end_x) + 6, y.coordinate(end_y)) +
           path_point('L', curves_right + 12, heights[i]) + "\" stroke=\"" +
           series[i].style.colour + "\" stroke-width=\"0.6\" opacity=\"0.6\"/>";
    svg += text_at(curves_right + 15, heights[i] + 4, "fill=\"" + series[i].style.colour + "\"",
                   escaped(series[i].label));
  }
  return svg;
}

/// Title, names of the axes, and grid lines of the y axis.
std::string frame_svg(const PlotText& text, const Axis& y, double right) {
  std::string svg =
      svg_head(width, height) + title_at(left, 18, text.title) +
      text_at((left + right) / 2, height - 12, "text-anchor=\"middle\"", escaped(text.x)) +
      "<text transform=\"translate(14 " + fixed((top + bottom) / 2) +
      ") rotate(-90)\" text-anchor=\"middle\">" + escaped(text.y) + "</text>\n";
  for (const double value : y.ticks())
    svg += line(left, y.coordinate(value), right, y.coordinate(value), grid_colour) +
           text_at(left - 7, y.coordinate(value) + 4, "text-anchor=\"end\"", y.tick_label(value));
  return svg;
}

std::string curve_plot(const std::vector<Series>& series, const PlotText& text,
                       std::vector<double> ticks, AxisScale scale) {
  std::vector<Series> shown;
  Axis x{.scale = scale, .from = left, .to = curves_right};
  Axis y{.from = bottom, .to = top};
  for (Series one : series) {
    std::erase_if(one.points,
                  [&](const auto& p) { return !x.can_show(p.first) || !y.can_show(p.second); });
    for (const auto& [a, b] : one.points) {
      x.include(a);
      y.include(b);
    }
    if (!one.points.empty())
      shown.push_back(std::move(one));
  }
  x.finish();
  y.finish();
  if (ticks.empty())
    ticks = x.ticks();
  std::string svg = frame_svg(text, y, curves_right);
  for (const double value : ticks)
    svg += line(x.coordinate(value), top, x.coordinate(value), bottom, grid_colour) +
           text_at(x.coordinate(value), bottom + 16, "text-anchor=\"middle\"", x.tick_label(value));
  svg += line(left, bottom, curves_right, bottom, axis_colour) +
         line(left, top, left, bottom, axis_colour);
  for (auto one = shown.rbegin(); one != shown.rend(); ++one)
    svg += curve_svg(*one, x, y);
  return svg + labels_svg(shown, x, y) + "</svg>\n";
}

/// A bar from the bottom of the plot to a value.
std::string bar_svg(double value, const Axis& y, double x, double bar_width,
                    const std::string& colour) {
  if (!y.can_show(value))
    return {};
  return "<rect x=\"" + fixed(x) + "\" y=\"" + fixed(y.coordinate(value)) + "\" width=\"" +
         fixed(bar_width) + "\" height=\"" + fixed(bottom - y.coordinate(value)) + "\" fill=\"" +
         colour + "\"/>\n";
}

} // namespace

std::string fixed(double number) {
  std::array<char, 48> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.1f", number);
  return buffer.data();
}

std::string svg_head(double width, double height) {
  return "<svg viewBox=\"0 0 " + fixed(width) + " " + fixed(height) +
         "\" role=\"img\" fill=\"#333\">\n";
}

std::string text_at(double x, double y, const std::string& attributes, const std::string& content) {
  return "<text x=\"" + fixed(x) + "\" y=\"" + fixed(y) + "\" " + attributes + ">" + content +
         "</text>\n";
}

std::string title_at(double x, double y, const std::string& text) {
  return text_at(x, y, "font-weight=\"600\" font-size=\"14\"", escaped(text));
}

std::string path_point(char command, double x, double y) {
  return std::string(1, command).append(fixed(x)).append(" ").append(fixed(y));
}

std::string line(double x0, double y0, double x1, double y1, const std::string& colour) {
  return "<path d=\"" + path_point('M', x0, y0) + path_point('L', x1, y1) + "\" stroke=\"" +
         colour + "\"/>\n";
}

bool Axis::can_show(double value) const {
  return std::isfinite(value) && (value > 0 || scale == AxisScale::Linear);
}

void Axis::include(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

void Axis::finish() {
  if (high < low)
    low = high = 1;
  if (scale == AxisScale::Linear) {
    high += high > low ? 0 : 1;
    return;
  }
  const double margin = std::max(1.12, std::pow(high / low, 0.04));
  low /= margin;
  high *= margin;
}

double Axis::coordinate(double value) const {
  if (scale == AxisScale::Linear)
    return from + (to - from) * (value - low) / (high - low);
  return from + (to - from) * std::log(value / low) / std::log(high / low);
}

std::vector<double> Axis::ticks() const {
  std::vector<double> result;
  const bool dense = high / low < 100;
  for (double power = std::floor(std::log10(low)); power <= std::log10(high); ++power)
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10, power);
      if ((dense || factor == 1) && value >= low && value <= high)
        result.push_back(value);
    }
  return result;
}

std::string Axis::tick_label(double value) const {
  if (scale == AxisScale::Linear)
    return std::to_string(std::lround(value)).append("°");
  if (value >= 1 && value < 99999)
    return std::to_string(std::lround(value));
  if (value >= 0.0099 && value < 1)
    return number_html(value);
  const double power = std::floor(std::log10(value) + 1e-9);
  const long factor = std::lround(value / std::pow(10, power));
  std::string text = factor == 1 ? std::string() : std::to_string(factor).append("·");
  return text.append("10<tspan dy=\"-5\" font-size=\"8\">")
      .append(std::to_string(std::lround(power)))
      .append("</tspan>");
}

std::string series_colour(std::size_t index) { return colours[index % colours.size()]; }

std::string swatch_svg(const PlotStyle& style) {
  return "<svg class=\"swatch\" width=\"30\" height=\"12\"><path d=\"M1 6h28\" stroke=\"" +
         style.colour + "\" stroke-width=\"2\"" +
         (style.dashed ? " stroke-dasharray=\"4 3\"" : "") + "/>" + marker_svg(style, 15, 6) +
         "</svg>";
}

std::string log_plot(const std::vector<Series>& series, const PlotText& text,
                     const std::vector<double>& ticks) {
  return curve_plot(series, text, ticks, AxisScale::Logarithmic);
}

std::string angle_plot(const std::vector<Series>& series, const PlotText& text,
                       const std::vector<double>& ticks) {
  return curve_plot(series, text, ticks, AxisScale::Linear);
}

std::string bar_plot(const std::vector<Bar>& bars, const PlotText& text,
                     const std::string& colour) {
  Axis y{.from = bottom, .to = top};
  for (const Bar& bar : bars)
    for (const double value : {bar.value, bar.limit})
      if (y.can_show(value))
        y.include(value);
  y.finish();
  const double step =
      (bars_right - left) / static_cast<double>(std::max<std::size_t>(1, bars.size()));
  std::string svg = frame_svg(text, y, bars_right);
  double x = left;
  for (const Bar& bar : bars) {
    svg += bar_svg(bar.limit, y, x + 0.1 * step, 0.8 * step, "#dddddd") +
           bar_svg(bar.value, y, x + 0.1 * step, 0.8 * step, colour) +
           text_at(x + step / 2, bottom + 16, "text-anchor=\"middle\"", escaped(bar.label));
    x += step;
  }
  return svg + line(left, bottom, bars_right, bottom, axis_colour) + "</svg>\n";
}

} // namespace haarlight::html
