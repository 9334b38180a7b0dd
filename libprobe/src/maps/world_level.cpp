#include "maps/map_rotation.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>

namespace haarlight::probe {
namespace {

constexpr int reach = 2;
constexpr int neighbours = (2 * reach + 1) * (2 * reach + 1) - 1;
constexpr float brightest = 3; ///< times the mean of the neighbours, as for the probe's own pixels

/// The pixel that stands at (x, y), which may lie a few steps over an edge: edges are folded onto
/// themselves.
Rgb folded_pixel(const wavelet::Map& map, int x, int y) {
  const int last = map.size - 1;
  const auto inside = [&](int i) { return i < 0 ? -1 - i : (i > last ? 2 * last + 1 - i : i); };
  const int from_x = inside(x);
  const int from_y = inside(y);
  return map.at(from_y != y ? last - from_x : from_x, from_x != x ? last - from_y : from_y);
}

float luminance_around(const wavelet::Map& map, int x, int y) {
  float sum = 0;
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i)
      if (i != 0 || j != 0)
        sum += luminance(folded_pixel(map, x + i, y + j));
  return sum;
}

/// Points that stand for a pixel as the interpolation would show it: a tent two pixels wide.
void add_lights(std::vector<WorldLevel::Light>& lights, int size, int x, int y, const Rgb& excess,
                int along) {
  const float pixel = wavelet::sphere_area / static_cast<float>(size * size);
  const auto cells = static_cast<float>(along);
  // The tent's mean over its square is a quarter.
  const float share = along > 1 ? 4 / (cells * cells) : 1.0F;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < along; ++i) {
      const Vec2 step(2 * (static_cast<float>(i) + 0.5F) / cells - 1,
                      2 * (static_cast<float>(j) + 0.5F) / cells - 1);
      const float weight = (1 - std::abs(step.x())) * (1 - std::abs(step.y()));
      const Vec2 place = Vec2(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F) + step;
      // Over the edge the centre itself will do.
      const Vec2 square = place / static_cast<float>(size);
      const Vec2 held = square.cwiseMax(0.0F).cwiseMin(1.0F);
      lights.push_back({wavelet::square_to_sphere(held), excess * (pixel * weight * share)});
    }
}

/// Takes the excess of peaks out of a map and makes lights of it.
std::vector<WorldLevel::Light> take_lights(wavelet::Map& map, int along) {
  const wavelet::Map whole = map;
  std::vector<WorldLevel::Light> lights;
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      const Rgb value = whole.at(x, y);
      const float limit = luminance_around(whole, x, y) * (brightest / neighbours);
      if (luminance(value) <= limit)
        continue;
      const Rgb base = value * (limit / luminance(value));
      map.set(x, y, base);
      add_lights(lights, map.size, x, y, value - base, along);
    }
  return lights;
}

} // namespace

WorldLevel make_level(const wavelet::Map& map, int size, int map_size) {
  wavelet::Map small = map;
  while (small.size > size)
    small = wavelet::halved(small);
  WorldLevel level;
  level.size = small.size;
  const int finer = map_size / small.size;
  level.lights = take_lights(small, finer > 1 ? 2 * finer : 1);
  const int side = small.size + 2;
  level.rgbx.resize(4 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                         static_cast<std::size_t>(x);
      Eigen::Map<Rgb>(level.rgbx.data() + 4 * index) = folded_pixel(small, x - 1, y - 1);
    }
  return level;
}

} // namespace haarlight::probe
