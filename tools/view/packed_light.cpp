#include <view/packed_light.h>

#include <wavelet/base/half.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>

namespace haarlight::view {
namespace {

/// What squares add up: radiance, and directions by weight.
struct Moments {
  Rgb radiance = Rgb::Zero();
  Vec3 directions = Vec3::Zero();
  float weight = 0;
};

using Level = std::vector<Moments>;

std::size_t index(int level, int x, int y) {
  return (static_cast<std::size_t>(y) << static_cast<unsigned>(level)) +
         static_cast<std::size_t>(x);
}

/// Even light over each pixel. Where it is black, directions count a little all the same.
Level finest(const wavelet::Map& map, int level) {
  const float side = 1.0F / static_cast<float>(map.size);
  const float spread = even_spread * side;
  const float least = 1e-6F * luminance(map_mean(map).cast<float>()) + 1e-30F;
  Level result(map.rgb.size() / 3);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      Moments& m = result[index(level, x, y)];
      m.radiance = map.at(x, y);
      m.weight = luminance(m.radiance) + least;
      m.directions = m.weight * std::sqrt(std::max(0.0F, 1 - spread * spread)) *
                     wavelet::square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) * side,
                                                    (static_cast<float>(y) + 0.5F) * side));
    }
  return result;
}

Level coarser(const Level& fine, int level) {
  Level result(fine.size() / 4);
  for (int y = 0; y < 1 << level; ++y)
    for (int x = 0; x < 1 << level; ++x)
      for (int q = 0; q < 4; ++q) {
        const Moments& part = fine[index(level + 1, 2 * x + q % 2, 2 * y + q / 2)];
        Moments& sum = result[index(level, x, y)];
        sum.radiance += 0.25F * part.radiance;
        sum.directions += 0.25F * part.directions;
        sum.weight += 0.25F * part.weight;
      }
  return result;
}

float spread_of(const Moments& m) {
  const float length = m.directions.norm() / m.weight;
  return std::sqrt(std::max(0.0F, (1 - length) * (1 + length)));
}

LightSquares squares_of(const Level& level, float unit) {
  LightSquares result;
  const auto put = [](std::vector<std::uint16_t>& texels, const auto& colour, float alpha) {
    for (int c = 0; c < 3; ++c)
      texels.push_back(wavelet::float_to_half(colour[c]));
    texels.push_back(wavelet::float_to_half(alpha));
  };
  for (const Moments& m : level) {
    put(result.radiance, Rgb(m.radiance / unit), spread_of(m));
    put(result.directions, Vec3(m.directions.normalized()), 0);
  }
  return result;
}

} // namespace

std::size_t PackedLight::bytes() const {
  std::size_t bytes = 0;
  for (const LightSquares& level : squares)
    bytes += 2 * (level.radiance.size() + level.directions.size());
  return bytes;
}

PackedLight pack_light(const wavelet::Map& map) {
  constexpr float largest_half = 32768; // leaves room for rounding
  PackedLight light;
  while (1 << light.levels < map.size)
    ++light.levels;
  const float largest = *std::max_element(map.rgb.begin(), map.rgb.end());
  light.unit = largest > 0 ? largest / largest_half : 1;
  light.squares.resize(static_cast<std::size_t>(light.levels) + 1);
  Level level = finest(map, light.levels);
  for (int l = light.levels; l >= 0; --l) {
    light.squares[static_cast<std::size_t>(l)] = squares_of(level, light.unit);
    if (l > 0)
      level = coarser(level, l - 1);
  }
  return light;
}

} // namespace haarlight::view
