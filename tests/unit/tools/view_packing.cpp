// Textures of the viewer: light, lobes and trees.
#include <view/packing.h>
#include <view/page.h>
#include <view/shaders.h>

#include <wavelet/base/half.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace haarlight;
using namespace haarlight::view;

namespace {

/// The texels of a texture.
template <class T>
std::vector<T> values(const ShaderInputs& inputs, const std::string& sampler) {
  for (const TextureData& texture : inputs.textures)
    if (texture.sampler == sampler) {
      std::vector<T> result(texture.bytes.size() / sizeof(T));
      std::memcpy(result.data(), texture.bytes.data(), texture.bytes.size());
      return result;
    }
  return {};
}

/// The only uniform float.
float unit_of(const ShaderInputs& inputs) { return inputs.floats.front().second.front(); }

float texel(const std::vector<std::uint16_t>& texels, std::size_t index, std::size_t channel) {
  return wavelet::half_to_float(texels[4 * index + channel]);
}

/// The first texel of a level of a texture whose mip levels begin with the finest.
std::size_t mip_offset(int levels, int level) {
  std::size_t offset = 0;
  for (int l = levels; l > level; --l)
    offset += std::size_t{1} << (2 * l);
  return offset;
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

/// The average over a square, as punctual.glsl computes it.
float average(const ShaderInputs& inputs, int level, int x, int y) {
  const auto coarse = values<std::uint16_t>(inputs, "coarse_averages");
  const auto coefficients = values<std::uint16_t>(inputs, "coefficients");
  const auto roots = values<std::uint32_t>(inputs, "subtree_roots");
  const auto links = values<std::uint32_t>(inputs, "links");
  const auto scales = values<float>(inputs, "scales");
  const int dense = std::min(level, dense_level);
  const int side = 1 << dense;
  const int x0 = dense == dense_level ? 0 : dense_side;
  const int y0 = dense == dense_level ? 0 : dense_side - 2 * side;
  const int row = y0 + (y >> (level - dense));
  const int column = x0 + (x >> (level - dense));
  float sum =
      texel(coarse, static_cast<std::size_t>(row * slice_width + column), 0) * unit_of(inputs);
  std::uint32_t node = 0;
  if (level > dense_level)
    node = roots[static_cast<std::size_t>((y >> (level - dense)) * dense_side +
                                          (x >> (level - dense)))];
  for (int l = level - dense_level - 1; l >= 0 && node != 0; --l) {
    const int qx = (x >> l) & 1;
    const int qy = (y >> l) & 1;
    const float sx = qx == 0 ? 1.0F : -1.0F;
    const float sy = qy == 0 ? 1.0F : -1.0F;
    const std::size_t first = 3 * static_cast<std::size_t>(node - 1);
    sum +=
        scales[0] * (sx * texel(coefficients, first, 0) + sy * texel(coefficients, first + 1, 0) +
                     sx * sy * texel(coefficients, first + 2, 0));
    const std::uint32_t link = links[node - 1];
    const unsigned q = static_cast<unsigned>(qx + 2 * qy);
    const std::uint32_t before = wavelet::detail::bits_of_nibble(link & ((1U << q) - 1U));
    node = ((link >> q) & 1U) != 0 ? (link >> 4U) + before + 1 : 0;
  }
  return sum;
}

} // namespace

TEST_CASE("the mean of a light is the same at every level", "[view]") {
  const wavelet::Map map = uneven(32);
  const PackedLight light = pack_light(map);
  REQUIRE(light.levels == 5);
  const auto squares = values<std::uint16_t>(light.inputs, "light_squares");
  for (int level = 0; level <= 5; ++level) {
    const std::size_t count = std::size_t{1} << (2 * level);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
      sum +=
          static_cast<double>(texel(squares, mip_offset(5, level) + i, 1) * unit_of(light.inputs));
    CHECK(sum / static_cast<double>(count) == Approx(map_mean(map)[1]).epsilon(1e-3));
  }
}

TEST_CASE("a single bright pixel keeps its direction at every level", "[view]") {
  wavelet::Map map(64);
  map.set(50, 9, Rgb(5, 6, 7));
  const Vec3 direction = wavelet::square_to_sphere(Vec2(50.5F / 64, 9.5F / 64));
  const PackedLight light = pack_light(map);
  const auto squares = values<std::uint16_t>(light.inputs, "light_squares");
  const auto directions = values<std::uint16_t>(light.inputs, "light_directions");
  for (int l = 0; l <= light.levels; ++l) {
    const std::size_t index = mip_offset(light.levels, l) +
                              static_cast<std::size_t>(((9 << l) / 64 << l) + (50 << l) / 64);
    for (std::size_t c = 0; c < 3; ++c)
      CHECK(texel(directions, index, c) == Approx(direction[static_cast<int>(c)]).margin(2e-3));
    CHECK(texel(squares, index, 3) < 2 * uniform_spread / 64);
  }
}

TEST_CASE("uniform light has the spread of its squares", "[view]") {
  wavelet::Map map(64);
  std::fill(map.rgb.begin(), map.rgb.end(), 2.0F);
  const PackedLight light = pack_light(map);
  const auto squares = values<std::uint16_t>(light.inputs, "light_squares");
  CHECK(texel(squares, mip_offset(light.levels, 0), 3) == Approx(1).epsilon(1e-3));
  for (int l = 3; l <= light.levels; ++l) {
    const auto middle = static_cast<std::size_t>((1 << l) * (1 << l) / 2 + (1 << l) / 2);
    CHECK(texel(squares, mip_offset(light.levels, l) + middle, 3) ==
          Approx(std::ldexp(uniform_spread, -l)).epsilon(0.1));
  }
}

TEST_CASE("lobes hold averages and deviations, with a border", "[view]") {
  const wavelet::Tree tree = tree_of(uneven(128));
  const wavelet::TreeView view = tree.view();
  const std::span<const wavelet::TreeView> set(&view, 1);
  const ShaderInputs inputs = pack_lobes(std::span(&set, 1));
  const auto lobes = values<std::uint16_t>(inputs, "lobes");
  const float unit = unit_of(inputs);
  REQUIRE(inputs.integers.front().second == 8);
  REQUIRE(lobes.size() ==
          4 * static_cast<std::size_t>(lobe_width) * static_cast<std::size_t>(lobe_row(9)));
  for (int level = 0; level <= 7; ++level) {
    const int side = std::min(1 << level, window_side);
    const int first = ((1 << level) - side) / 2;
    const auto place = static_cast<std::size_t>((lobe_row(level) + 1 + side / 2) * lobe_width + 1);
    CHECK(texel(lobes, place, 2) * unit ==
          Approx(view.average(level, first, first + side / 2)[2]).epsilon(0.005));
  }
  CHECK(texel(lobes, static_cast<std::size_t>(lobe_width + 1), 3) * unit ==
        Approx(std::sqrt(1.0 / 12 * (0.2126 * 0.2126 + 0.7152 * 0.7152 + 0.0722 * 0.0722)))
            .epsilon(0.1));
  // Across the left edge lies the same edge, upside down.
  const auto row = [&](int y) {
    return static_cast<std::size_t>((lobe_row(3) + 1 + y) * lobe_width);
  };
  CHECK(texel(lobes, row(2), 0) == texel(lobes, row(5) + 1, 0));
}

TEST_CASE("packed trees reconstruct to the same averages", "[view]") {
  const wavelet::Tree tree = tree_of(uneven(128));
  const wavelet::TreeView view = tree.view();
  const ShaderInputs inputs = pack_trees(std::span(&view, 1));
  for (int level = 0; level <= 7; ++level)
    for (int i = 0; i < 5; ++i) {
      const int x = i * 37 % (1 << level);
      const int y = i * 53 % (1 << level);
      CHECK(average(inputs, level, x, y) == Approx(view.average(level, x, y)[0]).epsilon(1e-3));
    }
}

TEST_CASE("every texel format has a name, which the page's script knows", "[view]") {
  const std::string script = page_script();
  for (std::size_t i = 0; i < texel_format_count; ++i) {
    const std::string name = texel_format_name(static_cast<TexelFormat>(i));
    CHECK(script.find("  " + name + ": [gl && gl.") != std::string::npos);
  }
  CHECK(std::string(texel_format_name(TexelFormat::Rgba32Ui)) == "Rgba32Ui");
}
