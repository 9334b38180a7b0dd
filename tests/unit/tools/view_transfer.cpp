// Textures of relight.glsl: transfer by pixel, and the coefficients of the light.
#include <view/transfer.h>

#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <cstring>

using namespace haarlight;
using namespace haarlight::view;

namespace {

/// From 0 to 1 with a bright pixel; the hues differ.
wavelet::Map lit(int size, std::size_t seed) {
  wavelet::Map map(size);
  for (std::size_t i = 0; i < map.rgb.size(); ++i)
    map.rgb[i] = static_cast<float>((i + seed) * 2654435761U % 1000U) / 1000.0F;
  map.rgb[(7 * seed) % map.rgb.size()] = 200;
  return map;
}

wavelet::Tree tree_of(const wavelet::Map& map, float tolerance) {
  wavelet::CompressOptions options;
  options.threshold.tolerance = tolerance;
  options.coefficients = wavelet::CoefficientType::Float;
  wavelet::CompressReport report;
  return compress_map(map, options, report);
}

std::uint32_t number(const TextureData& texture, std::size_t index) {
  std::uint32_t value = 0;
  std::memcpy(&value, texture.bytes.data() + 4 * index, 4);
  return value;
}

float real(const TextureData& texture, std::size_t index) {
  return std::bit_cast<float>(number(texture, index));
}

/// Channel c of the difference m of a texel, in the texel's unit.
int difference(const TextureData& texture, std::size_t place, unsigned m, unsigned c) {
  const int bits = static_cast<int>(number(texture, 4 * place + m) >> (10 * c) & 1023U);
  return bits < 512 ? bits : bits - 1024;
}

/// A pixel's channel as relight.glsl computes it, over the area of the sphere.
double relit(const ShaderInputs& transfer, const ShaderInputs& light, std::size_t pixel, unsigned c,
             int level) {
  const TextureData& nodes = transfer.textures[0];
  const TextureData& lights = light.textures[0];
  const std::size_t first = number(transfer.textures[1], pixel);
  const auto count = static_cast<std::size_t>(real(transfer.textures[2], 4 * pixel + 3));
  double sum = static_cast<double>(real(transfer.textures[2], 4 * pixel + c)) *
               static_cast<double>(light.floats[0].second[c]);
  for (std::size_t node = first; node < first + count; ++node) {
    const std::uint32_t last = number(nodes, 4 * node + 3);
    const std::size_t square = last >> 8U;
    if (static_cast<int>(square) >= squares_above(level))
      break;
    const double unit = std::ldexp(1.0, static_cast<int>(last & 255U) - 127) *
                        static_cast<double>(real(lights, 4 * square + 3));
    for (unsigned m = 0; m < 3; ++m)
      sum += unit * difference(nodes, node, m, c) * difference(lights, square, m, c);
  }
  return sum;
}

std::vector<renderer::FilmPoint> seen(std::size_t count) {
  std::vector<renderer::FilmPoint> points(count);
  for (renderer::FilmPoint& point : points)
    point.hit.object = 0;
  return points;
}

} // namespace

TEST_CASE("packed transfer keeps inner products with a light", "[view]") {
  const std::vector<wavelet::Tree> trees = {tree_of(lit(16, 1), 0), tree_of(lit(16, 3), 0.3F)};
  const std::vector<wavelet::TreeView> views = {trees[0].view(), trees[1].view()};
  const ShaderInputs transfer = pack_transfer(views, seen(2), 2, 1);
  const wavelet::DenseCoefficients dense(lit(16, 5));
  const ShaderInputs light = pack_light_coefficients(dense);
  std::vector<Rgb> truth(2);
  dense.inner_products(views, truth);
  for (std::size_t pixel = 0; pixel < 2; ++pixel)
    for (unsigned c = 0; c < 3; ++c)
      CHECK(relit(transfer, light, pixel, c, 4) ==
            Approx(static_cast<double>(truth[pixel][c])).epsilon(0.01));
}

TEST_CASE("packed transfer at a level uses the coefficients above that level", "[view]") {
  const wavelet::Tree tree = tree_of(lit(16, 1), 0);
  const ShaderInputs transfer = pack_transfer(std::vector{tree.view()}, seen(1), 1, 1);
  const wavelet::Map map = lit(16, 5);
  const ShaderInputs light = pack_light_coefficients(wavelet::DenseCoefficients(map));
  for (int level = 0; level <= 4; ++level) {
    const wavelet::Map coarse = tree_of(map, 0).view().reconstruct(level);
    const wavelet::Map own = tree.view().reconstruct(level);
    double truth = 0;
    for (std::size_t i = 0; i < own.rgb.size(); i += 3)
      truth += static_cast<double>(own.rgb[i]) * static_cast<double>(coarse.rgb[i]) /
               (static_cast<double>(own.size) * own.size);
    CHECK(relit(transfer, light, 0, 0, level) == Approx(truth).epsilon(0.01));
  }
}

TEST_CASE("pixels that hit no object are marked; trees without nodes are their means", "[view]") {
  wavelet::Map even(4);
  std::fill(even.rgb.begin(), even.rgb.end(), 0.25F);
  const wavelet::Tree tree = tree_of(even, 0);
  std::vector<renderer::FilmPoint> points = seen(2);
  points[0].hit.object = -1;
  const ShaderInputs transfer = pack_transfer(std::vector{tree.view(), tree.view()}, points, 1, 2);
  CHECK(real(transfer.textures[2], 3) == -1.0F);
  CHECK(real(transfer.textures[2], 7) == 0.0F);
  CHECK(real(transfer.textures[2], 4) == 0.25F);
  CHECK(transfer.textures[0].width == texels_per_row);
}
