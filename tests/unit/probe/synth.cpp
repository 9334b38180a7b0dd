#include "probe_files.h"

#include <probe/light_distribution.h>
#include <probe/synth.h>

#include <wavelet/base/parallel.h>

#include <cmath>

using namespace haarlight;
using namespace haarlight::probe;

namespace {

constexpr SceneKind kinds[] = {SceneKind::Studio, SceneKind::SunSky, SceneKind::Spheres};

/// Light from the directions within an angle of an axis, by quadrature over the cone's disk.
double cone_integral(const Scene& scene, const Vec3& axis, double radius) {
  const Frame frame = frame_about(axis);
  constexpr int rings = 400;
  constexpr int sectors = 64;
  double sum = 0;
  for (int j = 0; j < rings; ++j) {
    const double theta = radius * (j + 0.5) / rings;
    for (int i = 0; i < sectors; ++i) {
      const double phi = 2 * std::numbers::pi * i / sectors;
      const Vec3 local(static_cast<float>(std::sin(theta) * std::cos(phi)),
                       static_cast<float>(std::sin(theta) * std::sin(phi)),
                       static_cast<float>(std::cos(theta)));
      sum += luminance(scene.radiance(frame.to_outer(local))) * std::sin(theta);
    }
  }
  return sum * (radius / rings) * (2 * std::numbers::pi / sectors);
}

/// The same from an angular picture's pixels.
double cone_integral(const Probe& probe, const Vec3& axis, double radius) {
  double sum = 0;
  for (int y = 0; y < probe.height(); ++y)
    for (int x = 0; x < probe.width(); ++x)
      if (probe.direction(x, y).dot(axis) > std::cos(radius))
        sum += probe.pixel_solid_angle(x, y) * luminance(probe.pixel(x, y));
  return sum;
}

} // namespace

TEST_CASE("Synthetic probes are finite, bounded and black outside the disk", "[synth]") {
  for (const SceneKind kind : kinds) {
    const Image image = draw_angular(*make_scene(kind), 96);
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        const Rgb value = image.at(x, y);
        REQUIRE((value.isFinite().all() && (value >= 0).all() && value.maxCoeff() < 1e6F));
        const Vec2 uv((static_cast<float>(x) + 0.5F) / 96, (static_cast<float>(y) + 0.5F) / 96);
        if (radius_squared(uv) > 1.06F)
          REQUIRE((value == 0).all());
        else if (radius_squared(uv) < 0.97F)
          REQUIRE(luminance(value) > 0);
      }
    CHECK_NOTHROW(LightDistribution(Probe(image, Mapping::Angular)));
  }
}

TEST_CASE("Lamps have the right energy at any resolution", "[synth]") {
  const auto scene = make_scene(SceneKind::Spheres);
  const double background = luminance(scene->radiance({0, -1, 0}));
  double truth = 4 * std::numbers::pi * background;
  for (const BrightSpot& spot : scene->spots()) {
    const double radius = 1.2 * spot.radius;
    truth += cone_integral(*scene, spot.direction, radius) -
             background * 2 * std::numbers::pi * (1 - std::cos(radius));
  }
  for (const int size : {64, 100, 256}) {
    INFO(size);
    const Probe probe(draw_angular(*scene, size), Mapping::Angular);
    CHECK(luminance(probe.integral()) == Approx(truth).epsilon(0.01));
  }
}

TEST_CASE("The sun has the right energy at any resolution", "[synth]") {
  const auto scene = make_scene(SceneKind::SunSky);
  const BrightSpot sun = scene->spots().at(0);
  const Probe fine(draw_angular(*scene, 256), Mapping::Angular);
  const double radius = sun.radius + 12.0 / 256;
  CHECK(cone_integral(fine, sun.direction, radius) ==
        Approx(cone_integral(*scene, sun.direction, radius)).epsilon(0.02));
  for (const int size : {33, 64, 100}) {
    INFO(size);
    const Probe coarse(draw_angular(*scene, size), Mapping::Angular);
    CHECK(luminance(coarse.integral()) == Approx(luminance(fine.integral())).epsilon(0.005));
  }
}

TEST_CASE("The sun stands where it is placed and outshines the sky", "[synth]") {
  SceneOptions options;
  options.sun_elevation = 30;
  options.sun_azimuth = 90;
  const auto scene = make_scene(SceneKind::SunSky, options);
  const Vec3 sun(std::sqrt(0.75F), 0.5F, 0);
  CHECK((scene->spots().at(0).direction - sun).norm() < 1e-5F);
  const float zenith = luminance(scene->radiance({0, 1, 0}));
  CHECK(luminance(scene->radiance(sun)) > 1e4F * zenith);
  const Vec3 beside = (sun + Vec3(0, 0, 0.0051F)).normalized(); // 0.29°, just off the disk
  CHECK(luminance(scene->radiance(beside)) < 100 * zenith);
  // The sky is blue away from the sun, the ground grey and darker.
  const Rgb blue = scene->radiance(Vec3(-0.6F, 0.8F, 0));
  CHECK(blue[2] > 1.3F * blue[0]);
  CHECK(luminance(scene->radiance({0, -1, 0})) > 0);
}

TEST_CASE("A hazy evening is finite", "[synth]") {
  for (const double elevation : {0.0, 2.0, 90.0})
    for (const double turbidity : {2.0, 10.0}) {
      SceneOptions options;
      options.sun_elevation = elevation;
      options.turbidity = turbidity;
      const Image image = draw_angular(*make_scene(SceneKind::SunSky, options), 32);
      for (const float value : image.rgb)
        REQUIRE((std::isfinite(value) && value >= 0 && value < 1e6F));
    }
}

TEST_CASE("The seed varies what chance decides, threads do not", "[synth]") {
  for (const SceneKind kind : {SceneKind::Studio, SceneKind::Spheres}) {
    SceneOptions other;
    other.seed = 2;
    const auto one = draw_angular(*make_scene(kind), 40).rgb;
    CHECK(one != draw_angular(*make_scene(kind, other), 40).rgb);
    const ThreadLimit limit(1);
    CHECK(one == draw_angular(*make_scene(kind), 40).rgb);
  }
}
