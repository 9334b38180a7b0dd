#include "probe_files.h"

#include <probe/light_distribution.h>

#include <wavelet/square/sphere_map.h>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::probe;

namespace {

constexpr Mapping mappings[] = {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall,
                                Mapping::Octahedral};

/// Uneven, with dark pixels and one very bright, and a caption outside the disk.
Probe uneven_probe(Mapping mapping, Lookup lookup = Lookup::Nearest, int size = 24) {
  std::mt19937 random(23);
  std::uniform_real_distribution<float> uniform(0, 1);
  Image image(mapping == Mapping::LatLong ? 2 * size : size, size);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float value = random() % 4 == 0 ? 0.0F : uniform(random);
      image.set(x, y, {value, value, 0.5F * value});
    }
  image.set(size / 3, size / 2, {40, 40, 40});
  if (is_round(mapping))
    image.set(0, 0, {1e5F, 1e5F, 1e5F});
  return {image, mapping, lookup};
}

Vec2 random_point(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  return {uniform(random), uniform(random)};
}

int cell_of(const Vec3& w, int cells) {
  const Vec2 square = wavelet::sphere_to_square(w) * static_cast<float>(cells);
  const auto index = [&](float p) { return std::min(static_cast<int>(p), cells - 1); };
  return index(square.y()) * cells + index(square.x());
}

/// Integral of the pdf over each cell of a grid over the sphere.
std::vector<double> expected_shares(const LightDistribution& light, int cells, int points) {
  std::vector<double> shares(static_cast<std::size_t>(cells * cells), 0);
  const int grid = cells * points;
  for (int j = 0; j < grid; ++j)
    for (int i = 0; i < grid; ++i) {
      const Vec2 square((static_cast<float>(i) + 0.5F) / static_cast<float>(grid),
                        (static_cast<float>(j) + 0.5F) / static_cast<float>(grid));
      const double pdf = light.pdf(wavelet::square_to_sphere(square));
      shares[static_cast<std::size_t>(j / points * cells + i / points)] +=
          pdf * 4 * std::numbers::pi / grid / grid;
    }
  return shares;
}

} // namespace

TEST_CASE("Samples follow the pdf: chi-squared", "[light]") {
  constexpr int cells = 12;
  constexpr int samples = 200000;
  for (const Mapping mapping : mappings)
    for (const Lookup lookup : {Lookup::Nearest, Lookup::Bilinear}) {
      const LightDistribution light(uneven_probe(mapping, lookup));
      const std::vector<double> shares = expected_shares(light, cells, 50);
      std::vector<int> counts(shares.size(), 0);
      std::mt19937 random(29);
      for (int i = 0; i < samples; ++i)
        ++counts[static_cast<std::size_t>(
            cell_of(light.sample(random_point(random)).direction, cells))];
      double chi_squared = 0;
      double total = 0;
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const double expected = shares[i] * samples;
        chi_squared += std::pow(counts[i] - expected, 2) / std::max(expected, 5.0);
        total += shares[i];
      }
      INFO(mapping_name(mapping) << " chi² " << chi_squared << ", pdf integral " << total);
      CHECK(total == Approx(1).epsilon(0.003));
      // 143 degrees of freedom: 210 is passed with p < 0.0003. Quadrature adds a little.
      CHECK(chi_squared < 215);
    }
}

TEST_CASE("A sample's density is the pdf of its direction", "[light]") {
  std::mt19937 random(31);
  for (const Mapping mapping : mappings) {
    const LightDistribution light(uneven_probe(mapping));
    int different = 0;
    for (int i = 0; i < 20000; ++i) {
      const LightSample sample = light.sample(random_point(random));
      REQUIRE(sample.pdf > 0);
      REQUIRE(sample.direction.norm() == Approx(1).epsilon(1e-5));
      const float pdf = light.pdf(sample.direction);
      different += std::abs(pdf - sample.pdf) > 1e-2F * sample.pdf ? 1 : 0;
    }
    INFO(mapping_name(mapping));
    // Points on a pixel's very edge may round into the next.
    CHECK(different < 40);
  }
}

TEST_CASE("The pdf is luminance over its integral", "[light]") {
  std::mt19937 random(37);
  for (const Mapping mapping : mappings) {
    const Probe probe = uneven_probe(mapping, Lookup::Nearest, 64);
    const LightDistribution light(probe);
    const float whole = luminance(probe.integral());
    for (int i = 0; i < 2000; ++i) {
      const Vec2 uv = random_point(random);
      if (is_round(mapping) && radius_squared(uv) > 0.6F)
        continue;
      if (mapping == Mapping::LatLong && std::abs(uv.y() - 0.5F) > 0.4F)
        continue;
      const Vec3 w = image_to_direction(mapping, uv);
      INFO(mapping_name(mapping) << " " << uv.transpose());
      REQUIRE(light.pdf(w) ==
              Approx(luminance(probe.radiance(w)) / whole).epsilon(0.15).margin(1e-9));
    }
  }
}

TEST_CASE("Sampling the light estimates its integral without bias", "[light]") {
  for (const Mapping mapping : mappings)
    for (const Lookup lookup : {Lookup::Nearest, Lookup::Bilinear}) {
      const Probe probe = uneven_probe(mapping, lookup);
      const LightDistribution light(probe);
      constexpr int grid = 400;
      double sum = 0;
      for (int j = 0; j < grid; ++j)
        for (int i = 0; i < grid; ++i) {
          const Vec2 u((static_cast<float>(i) + 0.5F) / grid,
                       (static_cast<float>(j) + 0.5F) / grid);
          const LightSample sample = light.sample(u);
          sum += luminance(probe.radiance(sample.direction)) / sample.pdf;
        }
      double truth = luminance(probe.integral());
      if (lookup == Lookup::Bilinear) {
        truth = 0;
        for (int j = 0; j < grid; ++j)
          for (int i = 0; i < grid; ++i)
            truth += luminance(probe.radiance(
                         wavelet::square_to_sphere(Vec2((static_cast<float>(i) + 0.5F) / grid,
                                                        (static_cast<float>(j) + 0.5F) / grid)))) *
                     4 * std::numbers::pi / (grid * grid);
      }
      INFO(mapping_name(mapping));
      CHECK(sum / (grid * grid) == Approx(truth).epsilon(0.01));
    }
}

TEST_CASE("Nothing outside the disk is ever sampled", "[light]") {
  for (const Mapping mapping : {Mapping::Angular, Mapping::MirrorBall})
    for (const int size : {1, 2, 3, 8, 31}) {
      Image image(size, size);
      for (float& value : image.rgb)
        value = 1;
      const LightDistribution light(Probe(image, mapping));
      std::mt19937 random(41);
      for (int i = 0; i < 4000; ++i) {
        const LightSample sample = light.sample(random_point(random));
        REQUIRE(sample.direction.allFinite());
        REQUIRE(std::isfinite(sample.pdf));
        REQUIRE(sample.pdf > 0);
      }
    }
}

TEST_CASE("A single bright pixel is always found", "[light]") {
  for (const auto& [x, y] :
       {std::pair(0, 16), std::pair(31, 15), std::pair(16, 16), std::pair(5, 7)}) {
    Image image(32, 32);
    image.set(x, y, {3, 2, 1});
    const Probe probe(image, Mapping::Angular);
    const LightDistribution light(probe);
    std::mt19937 random(43);
    for (int i = 0; i < 1000; ++i) {
      const LightSample sample = light.sample(random_point(random));
      const Vec2 uv = direction_to_image(Mapping::Angular, sample.direction) * 32.0F;
      // Pixels just outside the disk show the nearest inside, so one step away is allowed.
      REQUIRE((uv - Vec2(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F))
                  .cwiseAbs()
                  .maxCoeff() < 1.51F);
    }
  }
}

TEST_CASE("Extreme points and extreme contrast", "[light]") {
  Image image(64, 32);
  for (float& value : image.rgb)
    value = 1e-6F;
  image.set(20, 9, {1e5F, 1e5F, 1e5F});
  const LightDistribution light(Probe(image, Mapping::LatLong));
  for (const float u : {0.0F, 0.5F, 0x1.fffffep-1F, 1.0F})
    for (const float v : {0.0F, 0.25F, 0x1.fffffep-1F, 1.0F})
      CHECK(std::isfinite(light.sample({u, v}).pdf));
  CHECK(light.pdf(Vec3(0, -1, 0)) > 0);
}

TEST_CASE("A black probe is sampled uniformly", "[light]") {
  for (const Mapping mapping : {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall}) {
    Image image(32, 32);
    image.set(0, 0, {1, 1, 1}); // a caption, or a pixel at the pole
    if (mapping == Mapping::LatLong)
      image.set(0, 0, {0, 0, 0});
    const LightDistribution light(Probe(image, mapping));
    for (const Vec2& u : {Vec2(0.1F, 0.4F), Vec2(0.5F, 0.5F), Vec2(0.8F, 0.3F)}) {
      const LightSample sample = light.sample(u);
      CHECK(sample.pdf == Approx(1 / (4 * pi)).epsilon(0.1)); // uniform in (u, v) within a pixel
      CHECK(light.pdf(sample.direction) == Approx(sample.pdf).epsilon(1e-3));
    }
  }
}
