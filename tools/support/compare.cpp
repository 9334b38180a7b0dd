#include <support/compare.h>

#include <support/arguments.h>
#include <support/tool.h>

#include <image/false_colour.h>
#include <image/image_exr.h>
#include <image/map_set_exr.h>
#include <image/png.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/tree_set.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <utility>

namespace haarlight::tool {
namespace {

using wavelet::MapPlace;
using wavelet::SetInfo;
using wavelet::SetKind;
using wavelet::SharedMaps;

struct OpenSet {
  std::string path;
  SharedMaps maps;
  bool grey = false; ///< holds luminance only

  const SetInfo& info() const { return maps->info(); }
};

bool begins_as_exr(const InputFile& file) {
  const auto bytes = file.beginning(4);
  return bytes.size() == 4 && std::memcmp(bytes.data(), "\x76\x2f\x31\x01", 4) == 0;
}

OpenSet open_set(const std::string& path) {
  const InputFile file(path);
  if (wavelet::begins_as_tree_set(file)) {
    auto trees = std::make_shared<const wavelet::TreeSet>(wavelet::open_tree_set(path));
    const bool grey = trees->channels() == 1;
    return {path, wavelet::tree_maps(std::move(trees)), grey};
  }
  if (!begins_as_exr(file))
    throw_input_error(path, "is neither a .haar file nor an EXR image", 0);
  return {path, std::make_shared<const image::ExrMapSource>(path)};
}

std::string values_of(const SetInfo& info) {
  switch (info.kind) {
  case SetKind::Brdf:
    return info.cosine ? "f_r cos" : "f_r without the cosine";
  case SetKind::Light:
    return info.world_frame ? "radiance in the world's frame" : "radiance in mirror frames";
  case SetKind::Transfer:
    return "a transfer";
  case SetKind::Generic:
    break;
  }
  return "plain values";
}

/// A generic set may hold anything.
void check_values(const OpenSet& a, const OpenSet& b) {
  const bool known = a.info().kind != SetKind::Generic && b.info().kind != SetKind::Generic;
  if (known && values_of(a.info()) != values_of(b.info()))
    throw_input_error(b.path, "holds " + values_of(b.info()) + ", " + a.path + " holds " +
                                  values_of(a.info()) + "; sets of the same are needed");
}

std::string grid_text(const SetInfo& info) {
  std::string text = std::to_string(info.columns) + " x " + std::to_string(info.rows) + " maps";
  return info.rolls > 1 ? text + " for " + std::to_string(info.rolls) + " rolls" : text;
}

void check_grids(const OpenSet& a, const OpenSet& b) {
  const bool rolls_known = a.info().kind == b.info().kind;
  if (a.info().columns != b.info().columns || a.info().rows != b.info().rows ||
      (rolls_known && a.info().rolls != b.info().rolls))
    throw_input_error(b.path, "has " + grid_text(b.info()) + ", " + a.path + " has " +
                                  grid_text(a.info()) +
                                  "; equal grids are needed, or one map of each (--tree)");
}

void unfold_both(OpenSet& a, OpenSet& b, std::vector<std::string>& notes) {
  if (a.info().fold == b.info().fold || a.info().rolls != b.info().rolls ||
      a.info().columns != b.info().columns)
    return;
  a.maps = wavelet::unfolded(a.maps);
  b.maps = wavelet::unfolded(b.maps);
  notes.push_back("the sets are folded in different ways; all " + std::to_string(a.info().rolls) +
                  " rolls are compared");
}

MapPlace place_in_b(const CompareInput& input, const SetInfo& info) {
  if (!input.tree_b.empty())
    return chosen_map(input.tree_b, info, "--tree-b");
  if (info.map_count() == 1)
    return {};
  return chosen_map(input.tree, info, "--tree of " + input.compared);
}

void take_map(OpenSet& set, const MapPlace& place) {
  set.maps = wavelet::one_map(set.maps, place.column, place.row);
}

void shrink_larger(const OpenSet& smaller, OpenSet& larger, std::vector<std::string>& notes) {
  const int size = smaller.info().size;
  if (larger.info().size <= size)
    return;
  notes.push_back(larger.path + ": maps of " + std::to_string(larger.info().size) +
                  " px are averaged to the " + std::to_string(size) + " px of " + smaller.path);
  larger.maps = wavelet::shrunk(larger.maps, size);
}

void reduce_colours(const OpenSet& grey, OpenSet& coloured, std::vector<std::string>& notes) {
  if (!grey.grey || coloured.grey)
    return;
  coloured.maps = wavelet::in_luminance(coloured.maps);
  notes.push_back(grey.path + ": holds luminance only, which is what is compared");
}

using wavelet::Map;

constexpr int smallest_side = 320; ///< that the legend's figures need

Map difference_of(const Map& a, const Map& b) {
  Map map(a.size);
  std::transform(b.rgb.begin(), b.rgb.end(), a.rgb.begin(), map.rgb.begin(), std::minus<>());
  return map;
}

void write_channels(const std::string& path, const ComparedMaps& maps) {
  const Map difference = difference_of(maps.a, maps.b);
  image::ExrImage picture;
  picture.width = picture.height = maps.a.size;
  const std::array<std::pair<const char*, const Map*>, 3> layers = {
      {{"", &difference}, {"A.", &maps.a}, {"B.", &maps.b}}};
  for (const auto& [layer, map] : layers)
    for (std::size_t c = 0; c < 3; ++c) {
      const float* first = &map->rgb[c];
      picture.channels.push_back({std::string(layer) + "RGB"[c], first, 3});
    }
  picture.texts = {{"haarlight:a", maps.name_a}, {"haarlight:b", maps.name_b}};
  image::write_exr(path, picture);
}

/// Luminance of B − A.
image::SignedField signed_difference(const ComparedMaps& maps) {
  const Map difference = difference_of(maps.a, maps.b);
  image::SignedField result{difference.size, {}};
  result.values.reserve(difference.rgb.size() / 3);
  for (std::size_t i = 0; i < difference.rgb.size(); i += 3)
    result.values.push_back(luminance(Eigen::Map<const Rgb>(difference.rgb.data() + i)));
  return result;
}

/// Pixels that a pixel of a map is shown as, along a side.
int enlargement(int size) { return (smallest_side + size - 1) / size; }

Image enlarged(const Image& picture) {
  const int factor = enlargement(picture.width);
  Image large(factor * picture.width, factor * picture.height);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x)
      large.set(x, y, picture.at(x / factor, y / factor));
  return large;
}

Image shown_map(Map map, int largest_side) {
  while (map.size > largest_side)
    map = wavelet::halved(map);
  Image picture;
  picture.width = picture.height = map.size;
  picture.rgb = std::move(map.rgb);
  return enlarged(picture);
}

Image shown_difference(image::SignedField field, int largest_side) {
  while (field.size > largest_side)
    field = image::halved(field);
  return image::false_colour_picture(field, enlargement(field.size));
}

} // namespace

ComparedSets open_compared(const CompareInput& input) {
  if (input.tree.empty() && !input.tree_b.empty())
    throw UsageError("--tree-b needs --tree");
  OpenSet a = open_set(input.reference);
  OpenSet b = open_set(input.compared);
  ComparedSets sets;
  sets.values = values_of(a.info().kind == SetKind::Generic ? b.info() : a.info());
  check_values(a, b);
  if (input.tree.empty()) {
    unfold_both(a, b, sets.notes);
  } else {
    sets.first_a = chosen_map(input.tree, a.info(), "--tree");
    sets.first_b = place_in_b(input, b.info());
    take_map(a, sets.first_a);
    take_map(b, sets.first_b);
  }
  check_grids(a, b);
  shrink_larger(a, b, sets.notes);
  shrink_larger(b, a, sets.notes);
  reduce_colours(a, b, sets.notes);
  reduce_colours(b, a, sets.notes);
  sets.a = a.maps;
  sets.b = b.maps;
  return sets;
}

std::vector<image::SheetEntry> comparison_pictures(const ComparedMaps& maps, int largest_side) {
  std::vector<image::SheetEntry> entries = {{shown_map(maps.a, largest_side), maps.name_a},
                                            {shown_map(maps.b, largest_side), maps.name_b}};
  const float gain = image::middle_grey_gain(entries.front().picture);
  for (image::SheetEntry& entry : entries) {
    image::brighten(entry.picture, gain);
    image::tone_map(entry.picture, {.tone_map = image::ToneMap::Filmic});
  }
  entries.push_back({shown_difference(signed_difference(maps), largest_side), "B - A"});
  return entries;
}

void write_comparison(const std::string& path, const ComparedMaps& maps) {
  if (has_extension(path, ".exr"))
    return write_channels(path, maps);
  std::vector<image::SheetEntry> entries = comparison_pictures(maps, 1024);
  entries[0].caption = std::string("A ").append(maps.name_a);
  entries[1].caption = std::string("B ").append(maps.name_b);
  image::write_png(path, image::contact_sheet(entries, {.columns = 3}));
}

} // namespace haarlight::tool
