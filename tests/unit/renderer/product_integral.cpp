// Pictures by the product integral, against sampled ones.

#include "sampler_fixture.h"

#include <renderer/film/render.h>
#include <renderer/visibility/product_integral.h>
#include <wavelet/base/parallel.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr int size = 16;

/// Shapes of all sorts close to each other on a plane, rough and diffuse.
SceneDescription crowded_scene() {
  SceneDescription scene = fixture().scene("glossy", "spheres");
  scene.light.rotate = 70;
  scene.light.background = false;
  MaterialDescription floor;
  floor.name = "floor";
  floor.lambert = Rgb(0.5F, 0.4F, 0.3F);
  scene.materials.push_back(floor);
  scene.camera.from = Vec3(0, 3, 6);
  scene.camera.to = Vec3(0, -0.2F, 0);
  scene.camera.fov = 36;
  scene.objects = {{Plane{Vec3(0, -1, 0), Vec3::UnitY()}, {}, 1},
                   {Sphere{Vec3(0.2F, 0, -0.6F), 1}, {}, 0},
                   {Torus{Vec3(-1.3F, -0.5F, 0.6F), Vec3(0.3F, 1, 0.4F), 0.6F, 0.2F}, {}, 1},
                   {Box{Vec3(0.9F, -1, 0.5F), Vec3(1.6F, -0.2F, 1.2F)}, {}, 0}};
  return scene;
}

Film by_integral(const LoadedScene& scene, int levels) {
  ProductIntegralOptions options;
  options.levels = levels;
  options.light_size = 256;
  return render_product_integral(scene, options, size, size).film;
}

struct Distance {
  double mean = 0;     ///< relative error of the mean luminance
  double relative = 0; ///< root mean square difference over the mean
};

Distance distance(const Film& found, const Film& expected) {
  double sum = 0;
  double difference = 0;
  double squares = 0;
  int count = 0;
  for (std::size_t i = 0; i < expected.count(); ++i) {
    if (expected.samples[i] == 0)
      continue;
    const auto a = static_cast<double>(luminance(expected.color(i)));
    const auto b = static_cast<double>(luminance(found.color(i)));
    sum += a;
    difference += b - a;
    squares += (b - a) * (b - a);
    ++count;
  }
  return {std::abs(difference) / sum, std::sqrt(squares / count) / (sum / count)};
}

} // namespace

TEST_CASE("the product integral is what samples converge to", "[product-integral]") {
  const SceneDescription description = crowded_scene();
  const LoadedScene scene(description, {}, SamplerKind::Product, true);
  RenderOptions options;
  options.spp = 2048;
  const Film sampled = render(scene, options, size, size).film;
  const Distance coarse = distance(by_integral(scene, 4), sampled);
  const Distance fine = distance(by_integral(scene, 7), sampled);
  CHECK(fine.mean < 0.005);
  CHECK(fine.relative < 0.02);
  CHECK(coarse.relative > 1.3 * fine.relative);
}

TEST_CASE("a white furnace shows the albedo, and shadows of a plane overhead",
          "[product-integral]") {
  SceneDescription description = crowded_scene();
  description.objects.resize(2);
  description.objects[0].shape = Plane{Vec3(0, 3.2F, 0), Vec3::UnitY()}; // above the camera
  description.camera.from = Vec3(0, 3, 0.1F);
  description.camera.to = Vec3(0.2F, 0, -0.6F);
  description.materials[0] = description.materials[1];
  const TemporaryFolder folder;
  description.light = {};
  description.light.probe = folder.file("white.hdr");
  description.light.mapping = "angular";
  description.light.background = false;
  Image white = probe::draw_angular(*probe::make_scene(probe::SceneKind::Studio), 64);
  std::fill(white.rgb.begin(), white.rgb.end(), 1.0F);
  probe::write_rgbe(description.light.probe, white);
  const LoadedScene scene(description, {}, SamplerKind::Product, true);
  const Film film = by_integral(scene, 6);
  int seen = 0;
  for (std::size_t i = 0; i < film.count(); ++i) {
    if (film.samples[i] == 0)
      continue;
    ++seen;
    const float up = film.normal[3 * i + 1];
    const float share = 0.5F * (1 - up); // of the light: what comes from below the plane
    CHECK(film.color(i)[0] == Approx(0.5F * share).margin(3e-3));
  }
  CHECK(seen > 50);
}

TEST_CASE("product integrals depend on scene and options alone, not on threads",
          "[product-integral]") {
  const SceneDescription description = crowded_scene();
  const LoadedScene scene(description, {}, SamplerKind::Product, true);
  std::vector<Film> films;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    films.push_back(by_integral(scene, 5));
  }
  CHECK(films[0].rgb == films[1].rgb);
  CHECK(films[0].samples == films[1].samples);
}
