#include "probe_files.h"

#include <probe/mapping.h>
#include <probe/read_probe.h>

#include <wavelet/square/sphere_map.h>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::real_probe;

namespace {

constexpr Mapping mappings[] = {Mapping::Angular, Mapping::LatLong, Mapping::MirrorBall,
                                Mapping::Octahedral};

Vec3 random_direction(std::mt19937& random) {
  std::uniform_real_distribution<float> uniform(0, 1);
  return wavelet::square_to_sphere(Vec2(uniform(random), uniform(random)));
}

bool same(const Vec3& a, const Vec3& b, float tolerance = 1e-5F) {
  return (a - b).norm() < tolerance;
}

} // namespace

TEST_CASE("Mapping names", "[mapping]") {
  for (const Mapping mapping : mappings)
    CHECK(parse_mapping(mapping_name(mapping)) == mapping);
  CHECK_FALSE(parse_mapping("auto"));
}

TEST_CASE("Directions survive the way to the image and back", "[mapping]") {
  std::mt19937 random(3);
  for (const Mapping mapping : mappings) {
    for (int i = 0; i < 20000; ++i) {
      const Vec3 w = random_direction(random);
      const Vec2 uv = direction_to_image(mapping, w);
      INFO(mapping_name(mapping) << " " << w.transpose());
      REQUIRE(uv.minCoeff() >= 0);
      REQUIRE(uv.maxCoeff() <= 1);
      // Next to the rim the mirror ball resolves directions like a square root.
      REQUIRE(
          same(image_to_direction(mapping, uv), w, mapping == Mapping::MirrorBall ? 2e-3F : 1e-5F));
    }
  }
}

TEST_CASE("The axes stand where the conventions say", "[mapping]") {
  const Vec3 right(1, 0, 0);
  const Vec3 up(0, 1, 0);
  const Vec3 forward(0, 0, -1);
  const auto at = [](Mapping mapping, float u, float v) {
    return image_to_direction(mapping, {u, v});
  };
  CHECK(same(at(Mapping::Angular, 0.5F, 0.5F), forward));
  CHECK(same(at(Mapping::Angular, 0.75F, 0.5F), right));
  CHECK(same(at(Mapping::Angular, 0.5F, 0.25F), up));
  CHECK(same(at(Mapping::Angular, 1.0F, 0.5F), -forward));
  CHECK(same(at(Mapping::LatLong, 0.5F, 0.5F), forward));
  CHECK(same(at(Mapping::LatLong, 0.75F, 0.5F), right));
  CHECK(same(at(Mapping::LatLong, 0.0F, 0.5F), -forward));
  CHECK(same(at(Mapping::LatLong, 0.3F, 0.0F), up));
  CHECK(same(at(Mapping::MirrorBall, 0.5F, 0.5F), -forward));
  CHECK(same(at(Mapping::MirrorBall, 0.5F + 0.5F * std::sqrt(0.5F), 0.5F), right));
  CHECK(same(at(Mapping::MirrorBall, 0.5F, 0.5F - 0.5F * std::sqrt(0.5F)), up));
  CHECK(same(at(Mapping::MirrorBall, 1.0F, 0.5F), forward));
  CHECK(same(at(Mapping::Octahedral, 0.5F, 0.5F), -forward));
  CHECK(same(at(Mapping::Octahedral, 1.0F, 0.5F), right));
}

TEST_CASE("The mirror ball obeys the law of reflection", "[mapping]") {
  const Vec2 uv(0.62F, 0.31F);
  const Vec2 ab(2 * uv.x() - 1, 1 - 2 * uv.y());
  const Vec3 normal(ab.x(), ab.y(), std::sqrt(1 - ab.squaredNorm()));
  CHECK(same(image_to_direction(Mapping::MirrorBall, uv), mirror(Vec3(0, 0, 1), normal)));
}

TEST_CASE("The poles of every mapping are finite", "[mapping]") {
  for (const Mapping mapping : mappings)
    for (const Vec3& w : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(0, -1, 0),
                          Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1e-20F, 1), Vec3(1e-20F, 0, -1)}) {
      const Vec2 uv = direction_to_image(mapping, w);
      INFO(mapping_name(mapping) << " " << w.transpose());
      REQUIRE(uv.allFinite());
      CHECK(same(image_to_direction(mapping, uv), w, 1e-3F));
      CHECK(solid_angle_density(mapping, uv) > 0);
    }
}

TEST_CASE("The density is the Jacobian of the mapping", "[mapping]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0.12F, 0.88F);
  for (const Mapping mapping : mappings) {
    for (int i = 0; i < 200; ++i) {
      const Vec2 uv(uniform(random), uniform(random));
      if (!in_map(mapping, uv) || (is_round(mapping) && radius_squared(uv) > 0.9F))
        continue;
      constexpr float h = 2e-3F;
      const auto slope = [&](const Vec2& step) -> Eigen::Vector3d {
        return (image_to_direction(mapping, uv + step) - image_to_direction(mapping, uv - step))
                   .cast<double>() /
               (2.0 * h);
      };
      const double jacobian = slope({h, 0}).cross(slope({0, h})).norm();
      INFO(mapping_name(mapping) << " " << uv.transpose());
      // The octahedral map has creases, across which a difference says nothing.
      const bool crease =
          mapping == Mapping::Octahedral && std::abs(jacobian / (4 * pi) - 1) > 0.01;
      if (!crease)
        CHECK(solid_angle_density(mapping, uv) == Approx(jacobian).epsilon(2e-3));
    }
  }
}

namespace {

/// A smooth world with something in every direction.
Rgb landscape(const Vec3& w) {
  const float waves = 0.5F + 0.4F * std::sin(5 * w.x() + 1) * std::cos(4 * w.y()) + 0.2F * w.z();
  return Rgb(waves, 0.8F * waves + 0.1F, 0.9F * waves).max(0.01F);
}

Image picture_of(Mapping mapping, int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec2 uv((static_cast<float>(x) + 0.5F) / static_cast<float>(width),
                    (static_cast<float>(y) + 0.5F) / static_cast<float>(height));
      if (in_map(mapping, uv))
        image.set(x, y, landscape(image_to_direction(mapping, uv)));
    }
  return image;
}

} // namespace

TEST_CASE("The mapping is found by aspect and content", "[mapping]") {
  CHECK(detect_mapping(picture_of(Mapping::LatLong, 128, 64)).mapping == Mapping::LatLong);
  CHECK(detect_mapping(picture_of(Mapping::Octahedral, 64, 64)).mapping == Mapping::Octahedral);
  Image angular = picture_of(Mapping::Angular, 64, 64);
  CHECK(detect_mapping(angular).mapping == Mapping::Angular);
  for (int x = 1; x < 9; ++x)
    angular.set(x, 62, {1, 1, 1}); // a caption
  CHECK(detect_mapping(angular).mapping == Mapping::Angular);
  CHECK(detect_mapping(Image(1, 1)).mapping == Mapping::Angular);
  CHECK_THAT(haarlight::testing::error_of([] { detect_mapping(Image(65, 64), "probe.hdr"); }),
             Catch::Contains("probe.hdr: is 65") && Catch::Contains("square"));
}

TEST_CASE("The mapping of the real probes is found", "[mapping][shared-data]") {
  for (const char* name : {"grace_probe.hdr", "rnl_probe.hdr", "venice_sunset_angular_256.hdr",
                           "studio_small_03_angular_256.hdr"})
    CHECK(read_probe(real_probe(name)).probe.mapping() == Mapping::Angular);
  for (const char* name : {"grace_probe_latlong_512x256_hdrshop.hdr", "venice_sunset_1k.hdr"})
    CHECK(read_probe(real_probe(name)).probe.mapping() == Mapping::LatLong);
}

TEST_CASE("grace as angular map agrees with its independent lat-long", "[mapping][shared-data]") {
  const Probe angular =
      read_probe(real_probe("grace_probe.hdr"), std::nullopt, Lookup::Bilinear).probe;
  const Probe latlong = read_probe(real_probe("grace_probe_latlong_512x256_hdrshop.hdr")).probe;
  CHECK(luminance(angular.integral()) == Approx(luminance(latlong.integral())).epsilon(0.01));
  double n = 0;
  Eigen::Vector2d sum(0, 0);
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  for (int y = 0; y < latlong.height(); ++y)
    for (int x = 0; x < latlong.width(); ++x) {
      const double weight = latlong.pixel_solid_angle(x, y);
      const Eigen::Vector2d logs(
          std::log(luminance(latlong.pixel(x, y)) + 1e-4),
          std::log(luminance(angular.radiance(latlong.direction(x, y))) + 1e-4));
      n += weight;
      sum += weight * logs;
      products += weight * logs * logs.transpose();
    }
  const Eigen::Matrix2d covariance = products / n - sum * sum.transpose() / (n * n);
  const double correlation = covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1));
  INFO("correlation " << correlation);
  CHECK(correlation >= 0.99);
}
