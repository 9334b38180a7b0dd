#include <info/lobes.h>

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace haarlight::info {
namespace {

using wavelet::MapPlace;
using wavelet::SetInfo;
using wavelet::TreeSet;

constexpr double degree = std::numbers::pi / 180;
constexpr double range = 1e6;

double theta_of(const SetInfo& info, const MapPlace& place) {
  return (place.column + 0.5) * 90 / info.columns;
}

/// Of the plane of incidence about the mirror direction, degrees.
double roll_of(const SetInfo& info, const MapPlace& place) {
  return info.rolls > 1 ? (place.row + 0.5) * 360 / info.rolls : 0;
}

/// In the frame of <brdf/brdf_maps.h>, whose z is the mirror direction; the normal leans towards
/// the roll's azimuth.
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

} // namespace

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

Lobes lobes_of(const TreeSet& set, const std::vector<MapPlace>& places, Plane plane) {
  Lobes result;
  for (const MapPlace& place : places)
    result.lobes.push_back(lobe_of(set, place, plane));
  for (const Lobe& lobe : result.lobes)
    for (const auto& [angle, value] : lobe.points)
      result.scale.high = std::max(result.scale.high, value);
  result.scale.low = result.scale.high / range;
  for (Lobe& lobe : result.lobes)
    for (auto& [angle, value] : lobe.points)
      value = std::max(value, result.scale.low);
  return result;
}

} // namespace haarlight::info
