#include <info/page.h>

#include <html/page.h>

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

struct ComparedMap {
  MapPlace place;
  Difference difference;
};

std::vector<ComparedMap> compare_all(const tool::ComparedSets& sets) {
  const wavelet::SetInfo& info = sets.a->info();
  std::vector<ComparedMap> maps(static_cast<std::size_t>(info.map_count()));
  parallel_for(maps.size(), [&](std::size_t i) {
    const int index = static_cast<int>(i);
    const MapPlace place{index % info.columns, index / info.columns};
    maps[i] = {place, compare_maps(sets.a->make(place.column, place.row),
                                   sets.b->make(place.column, place.row))
                          .difference};
  });
  return maps;
}

double relative_l2(const std::vector<ComparedMap>& maps) {
  Difference sum;
  for (const ComparedMap& map : maps) {
    sum.squared_error += map.difference.squared_error;
    sum.energy += map.difference.energy;
  }
  return sum.relative_l2();
}

/// Keeps the maps with the largest error, in decreasing order.
void keep_worst(std::vector<ComparedMap>& maps) {
  std::stable_sort(maps.begin(), maps.end(), [](const ComparedMap& a, const ComparedMap& b) {
    return a.difference.squared_error > b.difference.squared_error;
  });
  maps.resize(std::min(maps.size(), shown_maps));
}

/// Column and row in A.
std::string name_of(const tool::ComparedSets& sets, const MapPlace& place) {
  return std::to_string(sets.first_a.column + place.column) + "," +
         std::to_string(sets.first_a.row + place.row);
}

std::string worst_table(const tool::ComparedSets& sets, const std::vector<ComparedMap>& maps) {
  html::TableRow head;
  for (const char* name : {"column, row", "L2", "relative L2", "L∞", "PSNR, dB"})
    head.push_back(html::number_cell(name));
  std::vector<html::TableRow> rows;
  for (const ComparedMap& map : maps) {
    const Difference& d = map.difference;
    rows.push_back({html::number_cell(name_of(sets, map.place))});
    for (const double number : {d.l2(), d.relative_l2(), d.largest_error, d.psnr()})
      rows.back().push_back(html::number_cell(html::number_html(number)));
  }
  return html::table({head}, rows);
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
  std::vector<ComparedMap> maps = compare_all(sets);
  std::string html = "<h2>Worst maps</h2>\n<p>Compared with " +
                     html::escaped(base_name(input.reference)) +
                     ": relative L2 error of all maps " + html::number_html(relative_l2(maps)) +
                     ". The maps with the largest L2 error: original and reconstruction with "
                     "the same exposure, and the difference of luminance in the colours of its "
                     "legend.";
  for (const std::string& note : sets.notes)
    html += " Note: " + html::escaped(note) + ".";
  keep_worst(maps);
  html += "</p>\n" + worst_table(sets, maps);
  for (const ComparedMap& map : maps)
    html += pictures(sets, map.place);
  return html;
}

} // namespace haarlight::info
