#include <info/lobe_section.h>

#include <info/lobes.h>
#include <info/polar_plot.h>

#include <html/plot.h>

namespace haarlight::info {
namespace {

std::string slices(const Lobes& lobes, const html::PlotText& text,
                   const std::vector<double>& ticks) {
  std::vector<html::Series> series(lobes.lobes.size());
  for (std::size_t i = 0; i < series.size(); ++i) {
    series[i].label = lobe_name(lobes.lobes[i]);
    series[i].look.colour = lobe_colour(i);
    series[i].look.marker = html::no_marker;
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
  if (!(along.scale.low > 0) || !(across.scale.low > 0))
    return "<h2>Lobes</h2>\n<p>No map holds light along its mirror direction's planes.</p>\n";
  const std::string unit = std::string("luminance of f_r")
                               .append(set.info().cosine ? " cos θ, " : ", ")
                               .append(set.info().units == "sr^-1" ? "1/sr" : set.info().units);
  return "<h2>Lobes</h2>\n<p>Luminance along lines through the mirror direction, above the "
         "horizon. What is less than a millionth of a figure's largest value, or negative, is "
         "drawn as that. In the polar plot the normal is up, the mirror directions are to the "
         "right, marked at the rim, and the viewer is to the left.</p>\n<div class=\"plots\">" +
         slices(
             along,
             {"In the plane of incidence", "from the mirror direction, towards the normal", unit},
             {-90, -60, -30, 0, 30, 60, 90, 120, 150, 180}) +
         slices(across, {"Across the plane of incidence", "from the mirror direction", unit},
                {-90, -60, -30, 0, 30, 60, 90}) +
         polar_plot(along, "In the plane of incidence, by direction", unit) + "</div>\n";
}

} // namespace haarlight::info
