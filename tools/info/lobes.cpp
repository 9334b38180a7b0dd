#include <info/page.h>

#include <html/page.h>
#include <html/plot.h>

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace haarlight::info {
namespace {

using html::Axis;
using html::path_point;
using wavelet::MapPlace;
using wavelet::SetInfo;
using wavelet::TreeSet;

enum class Plane {
  Incidence, ///< of the normal and the mirror direction
  Across     ///< perpendicular to it, through the mirror direction
};

/// Luminance in one plane by angle.
struct Lobe {
  double theta = 0; ///< of the mirror direction from the normal, degrees: the centre of its cell
  std::vector<std::pair<double, double>>
      points; ///< degrees from the mirror direction, positive towards the normal, every half degree
              ///< above the horizon; and the luminance
};

/// Lobes of some trees on one scale.
struct Lobes {
  std::vector<Lobe> lobes;
  double low = 0;  ///< high / dynamic_range; smaller and negative values are raised to it
  double high = 0; ///< the largest luminance; 0 if there is none
};

constexpr double degree = std::numbers::pi / 180;
constexpr double dynamic_range = 1e6; ///< that the plots show

double theta_of(const SetInfo& info, const MapPlace& place) {
  return (place.column + 0.5) * 90 / info.columns;
}

/// Angle of the plane of incidence about the mirror direction, degrees.
double roll_of(const SetInfo& info, const MapPlace& place) {
  return info.rolls > 1 ? (place.row + 0.5) * 360 / info.rolls : 0;
}

/// In the frame of <brdf/brdf_maps.h>: z is the mirror direction, and the normal has the azimuth of
/// the roll.
Lobe lobe_of(const TreeSet& set, const MapPlace& place, Plane plane) {
  const wavelet::TreeView& tree = set.tree(place.column, place.row);
  Lobe lobe{.theta = theta_of(set.info(), place), .points = {}};
  const bool across = plane == Plane::Across;
  const double azimuth = (roll_of(set.info(), place) + (across ? 90 : 0)) * degree;
  for (int half = -360; half <= 360; ++half) {
    const double angle = half / 2.0;
    const double height = across ? std::cos(lobe.theta * degree) * std::cos(angle * degree)
                                 : std::cos((angle - lobe.theta) * degree);
    if (height < 1e-9)
      continue;
    const double sine = std::sin(angle * degree);
    const Vec3 direction(static_cast<float>(sine * std::cos(azimuth)),
                         static_cast<float>(sine * std::sin(azimuth)),
                         static_cast<float>(std::cos(angle * degree)));
    const Vec2 p = wavelet::sphere_to_square(direction);
    lobe.points.emplace_back(angle, static_cast<double>(luminance(tree.value(p.x(), p.y()))));
  }
  return lobe;
}

/// Up to five trees of one row, evenly spread over the columns of those given.
std::vector<MapPlace> spread_places(const std::vector<MapPlace>& trees) {
  std::vector<MapPlace> row;
  std::copy_if(trees.begin(), trees.end(), std::back_inserter(row),
               [&](const MapPlace& place) { return place.row == trees.front().row; });
  const std::size_t count = std::min<std::size_t>(5, row.size());
  std::vector<MapPlace> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back(row[count == 1 ? 0 : i * (row.size() - 1) / (count - 1)]);
  return places;
}

/// @param set of BRDF kind
Lobes lobes_of(const TreeSet& set, const std::vector<MapPlace>& places, Plane plane) {
  Lobes result;
  for (const MapPlace& place : places)
    result.lobes.push_back(lobe_of(set, place, plane));
  for (const Lobe& lobe : result.lobes)
    for (const auto& [angle, value] : lobe.points)
      result.high = std::max(result.high, value);
  result.low = result.high / dynamic_range;
  for (Lobe& lobe : result.lobes)
    for (auto& [angle, value] : lobe.points)
      value = std::max(value, result.low);
  return result;
}

// Layout of the polar plot.
constexpr double polar_width = 560;
constexpr double polar_height = 330;
constexpr double centre_x = 240;
constexpr double centre_y = 292;
constexpr double radius = 230;

struct PolarPoint {
  double x;
  double y;
};

/// @param angle from the normal towards the viewer, degrees
PolarPoint polar_point(double angle, double distance) {
  const double radians = angle * std::numbers::pi / 180;
  return {centre_x - distance * std::sin(radians), centre_y - distance * std::cos(radians)};
}

std::string arc_svg(double r) {
  return "<path d=\"" + path_point('M', centre_x - r, centre_y) + "A" + html::fixed(r) + " " +
         html::fixed(r) + " 0 0 1 " + html::fixed(centre_x + r) + " " + html::fixed(centre_y) +
         "\" fill=\"none\" stroke=\"#e4e4e4\"/>\n";
}

std::string polar_grid(const Axis& axis) {
  std::string svg = arc_svg(radius);
  for (const double value : axis.ticks()) {
    const double r = axis.coordinate(value);
    svg += arc_svg(r) + html::text_at(centre_x + r, centre_y + 15,
                                      "text-anchor=\"middle\" font-size=\"10\"",
                                      axis.tick_label(value));
  }
  for (int angle = -90; angle <= 90; angle += 15) {
    const PolarPoint rim = polar_point(angle, radius);
    svg += html::line(centre_x, centre_y, rim.x, rim.y,
                      angle % 90 == 0 ? html::axis_colour : html::grid_colour);
  }
  return svg;
}

std::string polar_curve(const Lobe& lobe, const Axis& axis, const std::string& colour) {
  std::string path;
  for (const auto& [angle, value] : lobe.points) {
    const PolarPoint place = polar_point(angle - lobe.theta, axis.coordinate(value));
    path += path_point(path.empty() ? 'M' : 'L', place.x, place.y);
  }
  const PolarPoint from = polar_point(-lobe.theta, radius - 8);
  const PolarPoint to = polar_point(-lobe.theta, radius + 8);
  return "<path d=\"" + path + "\" fill=\"none\" stroke-width=\"1.6\" stroke=\"" + colour +
         "\"/><path d=\"" + path_point('M', from.x, from.y) + path_point('L', to.x, to.y) +
         "\" stroke-width=\"2.5\" stroke=\"" + colour + "\"/>\n";
}

std::string lobe_colour(std::size_t i) { return html::series_colour(i == 2 ? 5 : i); }

/// As in θ_r = 45°.
std::string lobe_name(const Lobe& lobe) { return "θ_r = " + html::fixed(lobe.theta) + "°"; }

/// The normal is up, the mirror directions are to the right, marked at the rim, and the viewer is
/// to the left; the distance from the centre is logarithmic.
/// @param lobes in the plane of incidence @param title, unit plain text
std::string polar_plot(const Lobes& lobes, const std::string& title, const std::string& unit) {
  Axis axis{.from = 0, .to = radius};
  axis.low = lobes.low;
  axis.high = lobes.high;
  std::string svg =
      html::svg_head(polar_width, polar_height) + html::title_at(10, 18, title) + polar_grid(axis);
  for (std::size_t i = 0; i < lobes.lobes.size(); ++i) {
    svg += polar_curve(lobes.lobes[i], axis, lobe_colour(i));
    svg += html::text_at(484, 60 + 15 * static_cast<double>(i), "fill=\"" + lobe_colour(i) + "\"",
                         lobe_name(lobes.lobes[i]));
  }
  svg += html::text_at(centre_x, polar_height - 6, "text-anchor=\"middle\"", html::escaped(unit));
  return svg + "</svg>\n";
}

std::string slice_plot(const Lobes& lobes, const html::PlotText& text,
                       const std::vector<double>& ticks) {
  std::vector<html::Series> series(lobes.lobes.size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    series[i].label = lobe_name(lobes.lobes[i]);
    series[i].style.colour = lobe_colour(i);
    series[i].style.marker = html::no_marker;
    series[i].points = lobes.lobes[i].points;
  }
  return html::angle_plot(series, text, ticks);
}

} // namespace

std::string lobes_html(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& trees) {
  if (set.info().kind != wavelet::SetKind::Brdf)
    return {};
  const std::vector<wavelet::MapPlace> places = spread_places(trees);
  const Lobes along = lobes_of(set, places, Plane::Incidence);
  const Lobes across = lobes_of(set, places, Plane::Across);
  if (!(along.low > 0) || !(across.low > 0))
    return "<h2>Lobes</h2>\n<p>All maps are black along the planes through the mirror "
           "direction.</p>\n";
  const std::string unit = std::string("luminance of f_r")
                               .append(set.info().cosine ? " cos θ, " : ", ")
                               .append(set.info().units == "sr^-1" ? "1/sr" : set.info().units);
  return "<h2>Lobes</h2>\n<p>Luminance along lines through the mirror direction, above the "
         "horizon. Values below a millionth of a figure's largest value, and negative values, are "
         "drawn as that millionth. In the polar plot the normal is up, the mirror directions, "
         "marked at the rim, are to the right, and the viewer is to the left.</p>\n<div "
         "class=\"plots\">" +
         slice_plot(
             along,
             {"In the plane of incidence", "from the mirror direction, towards the normal", unit},
             {-90, -60, -30, 0, 30, 60, 90, 120, 150, 180}) +
         slice_plot(across, {"Across the plane of incidence", "from the mirror direction", unit},
                    {-90, -60, -30, 0, 30, 60, 90}) +
         polar_plot(along, "In the plane of incidence, by direction", unit) + "</div>\n";
}

} // namespace haarlight::info
