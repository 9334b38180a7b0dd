#include <html/bars.h>

#include <html/axis.h>
#include <html/svg.h>
#include <html/text.h>

#include <algorithm>

namespace haarlight::html {
namespace {

constexpr double width = 560;
constexpr double height = 380;
constexpr double left = 62;
constexpr double right = 545;
constexpr double top = 34;
constexpr double bottom = 330;

Axis axis_of(const std::vector<Bar>& bars) {
  Axis axis{.from = bottom, .to = top};
  for (const Bar& bar : bars)
    for (const double value : {bar.value, bar.limit})
      if (axis.can_show(value))
        axis.take(value);
  axis.finish();
  return axis;
}

std::string column(double value, const Axis& y, double x, double breadth,
                   const std::string& colour) {
  if (!y.can_show(value))
    return {};
  return box(x, y.place(value), breadth, bottom - y.place(value), colour);
}

std::string grid(const Axis& y) {
  std::string svg;
  for (const double value : y.ticks())
    svg += line(left, y.place(value), right, y.place(value), "#e4e4e4") +
           text_at(left - 7, y.place(value) + 4, "text-anchor=\"end\"", y.tick_text(value));
  return svg;
}

} // namespace

std::string bar_plot(const std::vector<Bar>& bars, const PlotText& text,
                     const std::string& colour) {
  const Axis y = axis_of(bars);
  const double step = (right - left) / static_cast<double>(std::max<std::size_t>(1, bars.size()));
  std::string svg = svg_head(width, height) +
                    text_at(left, 18, "font-weight=\"600\" font-size=\"14\"", escaped(text.title)) +
                    grid(y);
  double x = left;
  for (const Bar& bar : bars) {
    svg += column(bar.limit, y, x + 0.1 * step, 0.8 * step, "#dddddd");
    svg += column(bar.value, y, x + 0.1 * step, 0.8 * step, colour);
    svg += text_at(x + step / 2, bottom + 16, "text-anchor=\"middle\"", escaped(bar.label));
    x += step;
  }
  svg += line(left, bottom, right, bottom, "#777");
  svg += text_at((left + right) / 2, height - 12, "text-anchor=\"middle\"", escaped(text.x));
  return svg + "<text transform=\"translate(14 " + fixed((top + bottom) / 2) +
         ") rotate(-90)\" text-anchor=\"middle\">" + escaped(text.y) + "</text>\n</svg>\n";
}

} // namespace haarlight::html
