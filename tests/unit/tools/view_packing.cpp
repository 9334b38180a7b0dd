// What the viewer's shaders read: light and reflectance over squares of all levels.
#include <view/packed_light.h>
#include <view/packed_lobes.h>
#include <view/packed_trees.h>

#include <wavelet/base/half.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace haarlight;
using namespace haarlight::view;

namespace {

float texel(const std::vector<std::uint16_t>& texels, std::size_t index, std::size_t channel) {
  return wavelet::half_to_float(texels[4 * index + channel]);
}

/// All different, from 0.5 to 1.5.
wavelet::Map uneven(int size) {
  wavelet::Map map(size);
  for (std::size_t i = 0; i < map.rgb.size(); ++i)
    map.rgb[i] = 0.5F + static_cast<float>(i * 2654435761U % 1000U) / 1000.0F;
  return map;
}

wavelet::Tree tree_of(const wavelet::Map& map) {
  wavelet::CompressOptions options;
  options.threshold.tolerance = 0;
  options.coefficients = wavelet::CoefficientType::Float;
  wavelet::CompressReport report;
  return compress_map(map, options, report);
}

/// The average over a square, as trees.glsl finds it.
float average(const PackedTrees& packed, int level, int x, int y) {
  const int top = std::min(level, top_level);
  const int side = 1 << top;
  const int x0 = top == top_level ? 0 : top_side;
  const int y0 = top == top_level ? 0 : top_side - 2 * side;
  const int row = y0 + (y >> (level - top));
  const int column = x0 + (x >> (level - top));
  float sum =
      texel(packed.tops, static_cast<std::size_t>(row * slice_width + column), 0) * packed.top_unit;
  std::uint32_t node = 0;
  if (level > top_level)
    node = packed.starts[static_cast<std::size_t>((y >> (level - top)) * top_side +
                                                  (x >> (level - top)))];
  for (int l = level - top_level - 1; l >= 0 && node != 0; --l) {
    const int qx = (x >> l) & 1;
    const int qy = (y >> l) & 1;
    const float sx = qx == 0 ? 1.0F : -1.0F;
    const float sy = qy == 0 ? 1.0F : -1.0F;
    const std::size_t first = 3 * static_cast<std::size_t>(node - 1);
    sum += packed.scales[0] * (sx * texel(packed.coefficients, first, 0) +
                               sy * texel(packed.coefficients, first + 1, 0) +
                               sx * sy * texel(packed.coefficients, first + 2, 0));
    const std::uint32_t link = packed.links[node - 1];
    const unsigned q = static_cast<unsigned>(qx + 2 * qy);
    const std::uint32_t before = wavelet::detail::bits_of_nibble(link & ((1U << q) - 1U));
    node = ((link >> q) & 1U) != 0 ? (link >> 4U) + before + 1 : 0;
  }
  return sum;
}

} // namespace

TEST_CASE("light keeps its energy over the squares of all levels", "[view]") {
  const wavelet::Map map = uneven(32);
  const PackedLight light = pack_light(map);
  REQUIRE(light.levels == 5);
  for (const LightSquares& level : light.squares) {
    double sum = 0;
    for (std::size_t i = 0; i < level.radiance.size() / 4; ++i)
      sum += static_cast<double>(texel(level.radiance, i, 1) * light.unit);
    CHECK(sum * 4 / static_cast<double>(level.radiance.size()) ==
          Approx(map_mean(map)[1]).epsilon(1e-3));
  }
}

TEST_CASE("a lamp lies where it is, at every level", "[view]") {
  wavelet::Map map(64);
  map.set(50, 9, Rgb(5, 6, 7));
  const Vec3 direction = wavelet::square_to_sphere(Vec2(50.5F / 64, 9.5F / 64));
  const PackedLight light = pack_light(map);
  for (int l = 0; l <= light.levels; ++l) {
    const auto index = static_cast<std::size_t>(((9 << l) / 64 << l) + (50 << l) / 64);
    const LightSquares& level = light.squares[static_cast<std::size_t>(l)];
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(texel(level.directions, index, c) ==
            Approx(direction[static_cast<int>(c)]).margin(2e-3));
    CHECK(texel(level.radiance, index, 3) < 2 * even_spread / 64);
  }
}

TEST_CASE("even light spreads as much as its squares", "[view]") {
  wavelet::Map map(64);
  std::fill(map.rgb.begin(), map.rgb.end(), 2.0F);
  const PackedLight light = pack_light(map);
  CHECK(texel(light.squares[0].radiance, 0, 3) == Approx(1).epsilon(1e-3));
  for (int l = 3; l <= light.levels; ++l) {
    const LightSquares& level = light.squares[static_cast<std::size_t>(l)];
    const auto middle = static_cast<std::size_t>((1 << l) * (1 << l) / 2 + (1 << l) / 2);
    CHECK(texel(level.radiance, middle, 3) == Approx(std::ldexp(even_spread, -l)).epsilon(0.1));
  }
}

TEST_CASE("lobes hold averages and deviations, with their neighbours around", "[view]") {
  const wavelet::Tree tree = tree_of(uneven(128));
  const wavelet::TreeView view = tree.view();
  const std::span<const wavelet::TreeView> set(&view, 1);
  const PackedLobes lobes = pack_lobes(std::span(&set, 1));
  REQUIRE(lobes.levels == 8);
  REQUIRE(lobes.texels.size() ==
          4 * static_cast<std::size_t>(lobe_width) * static_cast<std::size_t>(lobe_row(9)));
  for (int level = 0; level <= 7; ++level) {
    const int side = std::min(1 << level, window_side);
    const int first = ((1 << level) - side) / 2;
    const auto place = static_cast<std::size_t>((lobe_row(level) + 1 + side / 2) * lobe_width + 1);
    CHECK(texel(lobes.texels, place, 2) * lobes.unit ==
          Approx(view.average(level, first, first + side / 2)[2]).epsilon(0.005));
  }
  CHECK(texel(lobes.texels, static_cast<std::size_t>(lobe_width + 1), 3) * lobes.unit ==
        Approx(std::sqrt(1.0 / 12 * (0.2126 * 0.2126 + 0.7152 * 0.7152 + 0.0722 * 0.0722)))
            .epsilon(0.1));
  // Across the left edge lies the same edge, upside down.
  const auto row = [&](int y) {
    return static_cast<std::size_t>((lobe_row(3) + 1 + y) * lobe_width);
  };
  CHECK(texel(lobes.texels, row(2), 0) == texel(lobes.texels, row(5) + 1, 0));
}

TEST_CASE("trees come out of their texels as they went in", "[view]") {
  const wavelet::Tree tree = tree_of(uneven(128));
  const wavelet::TreeView view = tree.view();
  const PackedTrees packed = pack_trees(std::span(&view, 1));
  for (int level = 0; level <= 7; ++level)
    for (int i = 0; i < 5; ++i) {
      const int x = i * 37 % (1 << level);
      const int y = i * 53 % (1 << level);
      CHECK(average(packed, level, x, y) == Approx(view.average(level, x, y)[0]).epsilon(1e-3));
    }
}
