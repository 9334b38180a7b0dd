#include <info/polar_plot.h>

#include <html/axis.h>
#include <html/look.h>
#include <html/svg.h>
#include <html/text.h>

#include <cmath>
#include <numbers>

namespace haarlight::info {
namespace {

constexpr double width = 560;
constexpr double height = 330;
constexpr double centre_x = 240;
constexpr double centre_y = 292;
constexpr double radius = 230;

using html::Axis;
using html::point;

struct Place {
  double x;
  double y;
};

/// @param angle from the normal towards the viewer, degrees
Place place_of(double angle, double distance) {
  const double radians = angle * std::numbers::pi / 180;
  return {centre_x - distance * std::sin(radians), centre_y - distance * std::cos(radians)};
}

std::string arc(double r) {
  return "<path d=\"" + point('M', centre_x - r, centre_y) + "A" + html::fixed(r) + " " +
         html::fixed(r) + " 0 0 1 " + html::fixed(centre_x + r) + " " + html::fixed(centre_y) +
         "\" fill=\"none\" stroke=\"#e4e4e4\"/>\n";
}

std::string grid(const Axis& axis) {
  std::string svg = arc(radius);
  for (const double value : axis.ticks()) {
    const double r = axis.place(value);
    svg += arc(r) + html::text_at(centre_x + r, centre_y + 15,
                                  "text-anchor=\"middle\" font-size=\"10\"", axis.tick_text(value));
  }
  for (int angle = -90; angle <= 90; angle += 15) {
    const Place rim = place_of(angle, radius);
    svg += html::line(centre_x, centre_y, rim.x, rim.y, angle % 90 == 0 ? "#777" : "#e4e4e4");
  }
  return svg;
}

std::string curve(const Lobe& lobe, const Axis& axis, const std::string& colour) {
  std::string path;
  for (const auto& [angle, value] : lobe.points) {
    const Place place = place_of(angle - lobe.theta, axis.place(value));
    path += point(path.empty() ? 'M' : 'L', place.x, place.y);
  }
  const Place from = place_of(-lobe.theta, radius - 8);
  const Place to = place_of(-lobe.theta, radius + 8);
  return "<path d=\"" + path + "\" fill=\"none\" stroke-width=\"1.6\" stroke=\"" + colour +
         "\"/><path d=\"" + point('M', from.x, from.y) + point('L', to.x, to.y) +
         "\" stroke-width=\"2.5\" stroke=\"" + colour + "\"/>\n";
}

} // namespace

std::string lobe_colour(std::size_t i) { return html::series_colour(i == 2 ? 5 : i); }

std::string lobe_name(const Lobe& lobe) { return "θ_r = " + html::fixed(lobe.theta) + "°"; }

std::string polar_plot(const Lobes& lobes, const std::string& title, const std::string& unit) {
  Axis axis{.from = 0, .to = radius};
  axis.low = lobes.scale.low;
  axis.high = lobes.scale.high;
  std::string svg =
      html::svg_head(width, height) +
      html::text_at(10, 18, "font-weight=\"600\" font-size=\"14\"", html::escaped(title)) +
      grid(axis);
  for (std::size_t i = 0; i < lobes.lobes.size(); ++i) {
    svg += curve(lobes.lobes[i], axis, lobe_colour(i));
    svg += html::text_at(484, 60 + 15 * static_cast<double>(i), "fill=\"" + lobe_colour(i) + "\"",
                         lobe_name(lobes.lobes[i]));
  }
  svg += html::text_at(centre_x, height - 6, "text-anchor=\"middle\"", html::escaped(unit));
  return svg + "</svg>\n";
}

} // namespace haarlight::info
