#include "maps/map_rotation.h"
#include "maps/peaks.h"

#include <algorithm>

namespace haarlight::probe {
namespace {

/// Of peaks: with as few samples as tables have, lights of 3 × 3 pixels need their exact area too
/// (energy of a sun in a map of a 16 × 16 table: off by up to 3 % at 3).
constexpr double contrast = 2;

Probe as_probe(const wavelet::Map& map) {
  Image image;
  image.width = map.size;
  image.height = map.size;
  image.rgb = map.rgb;
  return {image, Mapping::Octahedral};
}

/// Offset of a pixel, or of one in the border, one step outside.
std::size_t texel_offset(const WorldLevel& level, int x, int y) {
  return 4 * (static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(level.size + 2) +
              static_cast<std::size_t>(x + 1));
}

/// Every edge is folded onto itself.
void fill_border(WorldLevel& level) {
  const int last = level.size - 1;
  const auto copy = [&](int x, int y) {
    const int inside_x = std::clamp(x, 0, last);
    const int inside_y = std::clamp(y, 0, last);
    const std::size_t from = texel_offset(level, inside_y != y ? last - inside_x : inside_x,
                                          inside_x != x ? last - inside_y : inside_y);
    std::copy_n(level.rgbw.begin() + static_cast<std::ptrdiff_t>(from), 4,
                level.rgbw.begin() + static_cast<std::ptrdiff_t>(texel_offset(level, x, y)));
  };
  for (int i = -1; i <= level.size; ++i) {
    copy(i, -1);
    copy(i, level.size);
    copy(-1, i);
    copy(level.size, i);
  }
}

} // namespace

WorldLevel make_level(const wavelet::Map& map, int size) {
  wavelet::Map small = map;
  while (small.size > size)
    small = wavelet::halved(small);
  const Probe probe = as_probe(small);
  WorldLevel level;
  level.size = small.size;
  level.unit = radiance_unit(probe);
  level.rgbw.resize(texel_offset(level, level.size, level.size) + 4);
  for (int y = 0; y < level.size; ++y)
    for (int x = 0; x < level.size; ++x) {
      float* texel = level.rgbw.data() + texel_offset(level, x, y);
      const Rgb radiance = probe.pixel(x, y) / level.unit;
      std::copy_n(radiance.data(), 3, texel);
      texel[3] = 1;
    }
  for (const PixelPlace& place : find_peaks(probe, contrast)) {
    level.peaks.push_back({place.x, place.y, probe.pixel(place.x, place.y) / level.unit});
    std::fill_n(level.rgbw.data() + texel_offset(level, place.x, place.y), 4, 0.0F);
  }
  fill_border(level);
  return level;
}

} // namespace haarlight::probe
