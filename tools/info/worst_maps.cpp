#include <info/worst_maps.h>

#include <html/cells.h>
#include <html/png_uri.h>
#include <html/text.h>

#include <support/compare.h>

#include <wavelet/base/parallel.h>
#include <wavelet/file/input_file.h>
#include <wavelet/tree/compare.h>

#include <algorithm>
#include <cmath>

namespace haarlight::info {
namespace {

using wavelet::Difference;
using wavelet::MapPlace;

constexpr std::size_t shown_maps = 3;
constexpr int shown_side = 512;

struct Judged {
  MapPlace place;
  Difference difference;
};

std::vector<Judged> judged_maps(const tool::ComparedSets& sets) {
  const wavelet::SetInfo& info = sets.a->info();
  std::vector<Judged> maps(static_cast<std::size_t>(info.map_count()));
  parallel_for(maps.size(), [&](std::size_t i) {
    const int index = static_cast<int>(i);
    const MapPlace place{index % info.columns, index / info.columns};
    maps[i] = {place, compare_maps(sets.a->make(place.column, place.row),
                                   sets.b->make(place.column, place.row))
                          .difference};
  });
  return maps;
}

double relative_l2(const std::vector<Judged>& maps) {
  Difference sum;
  for (const Judged& map : maps) {
    sum.squared_error += map.difference.squared_error;
    sum.energy += map.difference.energy;
  }
  return sum.relative_l2();
}

/// The worst first.
void keep_worst(std::vector<Judged>& maps) {
  std::stable_sort(maps.begin(), maps.end(), [](const Judged& a, const Judged& b) {
    return a.difference.squared_error > b.difference.squared_error;
  });
  maps.resize(std::min(maps.size(), shown_maps));
}

/// Indices are those of A.
std::string name_of(const tool::ComparedSets& sets, const MapPlace& place) {
  return std::to_string(sets.first_a.column + place.column) + "," +
         std::to_string(sets.first_a.row + place.row);
}

std::string table(const tool::ComparedSets& sets, const std::vector<Judged>& maps) {
  std::string html = "<table><thead><tr>";
  for (const char* name : {"column, row", "L2", "relative L2", "L∞", "PSNR, dB"})
    html += html::figure_head(name);
  html += "</tr></thead><tbody>\n";
  for (const Judged& map : maps) {
    const Difference& d = map.difference;
    html += "<tr>" + html::figure_cell(name_of(sets, map.place));
    for (const double number : {d.l2(), d.relative_l2(), d.largest_error, d.psnr()})
      html += html::figure_cell(html::number_html(number));
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

std::string pictures(const tool::ComparedSets& sets, const MapPlace& place) {
  const std::string name = std::string(" ").append(name_of(sets, place));
  std::string html = "<div class=\"pictures maps\">\n";
  for (const image::SheetEntry& entry : tool::comparison_pictures(
           {sets.a->make(place.column, place.row), sets.b->make(place.column, place.row),
            "original" + name, "reconstruction" + name},
           shown_side))
    html += "<figure><img src=\"" + html::png_uri(entry.picture) + "\" alt=\"\"><figcaption>" +
            html::escaped(entry.caption == "B - A" ? "reconstruction − original" : entry.caption) +
            "</figcaption></figure>\n";
  return html + "</div>\n";
}

} // namespace

std::string worst_maps_html(const tool::CompareInput& input) {
  const tool::ComparedSets sets = tool::open_compared(input);
  std::vector<Judged> maps = judged_maps(sets);
  std::string html = "<h2>Worst maps</h2>\n<p>Against " +
                     html::escaped(base_name(input.reference)) +
                     ": relative L2 error of all maps " + html::number_html(relative_l2(maps)) +
                     ". Those that differ most by L2, original and reconstruction with one "
                     "exposure; the difference is of luminance, its colours as its legend tells.";
  for (const std::string& note : sets.notes)
    html += " Note: " + html::escaped(note) + ".";
  keep_worst(maps);
  html += "</p>\n" + table(sets, maps);
  for (const Judged& map : maps)
    html += pictures(sets, map.place);
  return html;
}

} // namespace haarlight::info
