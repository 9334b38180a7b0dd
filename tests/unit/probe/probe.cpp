#include "probe_files.h"

#include <probe/probe.h>

#include <wavelet/square/sphere_map.h>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::probe;

namespace {

constexpr Mapping mappings[] = {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall,
                                Mapping::Octahedral};

Image filled(int width, int height, const Rgb& value) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.set(x, y, value);
  return image;
}

Image filled_for(Mapping mapping, int size, const Rgb& value) {
  return filled(mapping == Mapping::LatLong ? 2 * size : size, size, value);
}

/// The picture with everything outside the disk replaced by a bright caption.
Image with_captions(Image image) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec2 uv((static_cast<float>(x) + 0.5F) / static_cast<float>(image.width),
                    (static_cast<float>(y) + 0.5F) / static_cast<float>(image.height));
      if (radius_squared(uv) > 1)
        image.set(x, y, {1e6F, 1e6F, 1e6F});
    }
  return image;
}

Vec3 random_direction(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  return wavelet::square_to_sphere(Vec2(uniform(random), uniform(random)));
}

} // namespace

TEST_CASE("Solid angles add up to the sphere", "[probe]") {
  for (const Mapping mapping : mappings)
    for (const int size : {1, 2, 3, 7, 64, 100}) {
      const Probe probe(filled_for(mapping, size, {1, 2, 3}), mapping);
      double sum = 0;
      for (int y = 0; y < probe.height(); ++y)
        for (int x = 0; x < probe.width(); ++x)
          sum += probe.pixel_solid_angle(x, y);
      INFO(mapping_name(mapping) << " " << size);
      CHECK(sum == Approx(4 * pi).epsilon(5e-5));
      CHECK((probe.integral() / static_cast<float>(sum)).isApprox(Rgb(1, 2, 3), 1e-5F));
    }
}

TEST_CASE("Captions contribute nothing", "[probe]") {
  std::mt19937 random(11);
  for (const Mapping mapping : {Mapping::Angular, Mapping::MirrorBall})
    for (const Lookup lookup : {Lookup::Nearest, Lookup::Bilinear})
      for (const int size : {1, 2, 5, 50, 64}) {
        const Probe probe(with_captions(filled(size, size, {1, 1, 1})), mapping, lookup);
        INFO(mapping_name(mapping) << " " << size);
        for (int i = 0; i < 5000; ++i)
          REQUIRE(probe.radiance(random_direction(random))[0] == Approx(1));
        for (const Vec3& w : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1e-3F, 0, 1).normalized()})
          REQUIRE(probe.radiance(w)[1] == Approx(1));
        CHECK(probe.integral()[0] == Approx(4 * pi).epsilon(5e-5));
      }
}

TEST_CASE("Nearest look-up shows the pixel a direction falls in", "[probe]") {
  std::mt19937 random(13);
  for (const Mapping mapping : mappings) {
    Image image = filled_for(mapping, 32, {0, 0, 0});
    for (std::size_t i = 0; i < image.rgb.size(); ++i)
      image.rgb[i] = static_cast<float>(i);
    const Probe probe(image, mapping);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Vec2 uv((static_cast<float>(x) + 0.5F) / static_cast<float>(image.width),
                      (static_cast<float>(y) + 0.5F) / static_cast<float>(image.height));
        if (in_map(mapping, uv)) {
          INFO(mapping_name(mapping) << " " << x << " " << y);
          REQUIRE((probe.radiance(probe.direction(x, y)) == image.at(x, y)).all());
          REQUIRE((probe.pixel(x, y) == image.at(x, y)).all());
        }
      }
  }
}

TEST_CASE("Bilinear look-up is smooth across seams and poles", "[probe]") {
  const auto world = [](const Vec3& w) { return Rgb(2 + w.x(), 2 + w.y(), 2 + w.z()); };
  std::mt19937 random(17);
  for (const Mapping mapping : {Mapping::Angular, Mapping::LatLong, Mapping::Octahedral}) {
    Image image = filled_for(mapping, 128, {0, 0, 0});
    const Probe shape(image, mapping);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        image.set(x, y, world(shape.direction(x, y)));
    const Probe probe(image, mapping, Lookup::Bilinear);
    float worst = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 w = random_direction(random);
      worst = std::max(worst, (probe.radiance(w) - world(w)).abs().maxCoeff());
    }
    INFO(mapping_name(mapping) << " " << worst);
    // Interpolation errs by the square of a pixel; a seam done wrong would show at its first power.
    CHECK(worst < (mapping == Mapping::LatLong ? 0.006F : 0.03F));
  }
}

TEST_CASE("The integral is the mean of the radiance", "[probe]") {
  std::mt19937 random(19);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const Mapping mapping : mappings) {
    Image image = filled_for(mapping, 16, {0, 0, 0});
    for (float& value : image.rgb)
      value = uniform(random);
    const Probe probe(is_round(mapping) ? with_captions(image) : image, mapping);
    Eigen::Array3d sum(0, 0, 0);
    constexpr int grid = 700;
    for (int j = 0; j < grid; ++j)
      for (int i = 0; i < grid; ++i)
        sum += probe
                   .radiance(wavelet::square_to_sphere(Vec2((static_cast<float>(i) + 0.5F) / grid,
                                                            (static_cast<float>(j) + 0.5F) / grid)))
                   .cast<double>();
    INFO(mapping_name(mapping));
    CHECK((sum * (4 * std::numbers::pi / (grid * grid)))
              .isApprox(probe.integral().cast<double>(), 1e-3));
  }
}

TEST_CASE("Round and octahedral probes must be square", "[probe]") {
  for (const Mapping mapping : {Mapping::Angular, Mapping::MirrorBall, Mapping::Octahedral})
    CHECK_THAT(haarlight::testing::error_of(
                   [&] { Probe(Image(9, 8), mapping, Lookup::Nearest, "p.hdr"); }),
               Catch::Contains("p.hdr: is 9") && Catch::Contains(mapping_name(mapping)));
  CHECK(Probe(Image(9, 8), Mapping::LatLong).width() == 9);
}
