#include <support/compare_picture.h>

#include <support/words.h>

#include <image/false_colour.h>
#include <image/image_exr.h>
#include <image/png.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace haarlight::tool {
namespace {

using Image;
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

Picture enlarged(const Picture& picture) {
  const int factor = enlargement(picture.width);
  Picture large(factor * picture.width, factor * picture.height);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x)
      large.set(x, y, picture.at(x / factor, y / factor));
  return large;
}

Picture shown_map(Map map, int largest_side) {
  while (map.size > largest_side)
    map = wavelet::halved(map);
  Picture picture;
  picture.width = picture.height = map.size;
  picture.rgb = std::move(map.rgb);
  return enlarged(picture);
}

Picture shown_difference(image::SignedField field, int largest_side) {
  while (field.size > largest_side)
    field = image::halved(field);
  return image::false_colour_picture(field, enlargement(field.size));
}

} // namespace

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
