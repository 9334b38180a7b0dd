#include "temporary_folder.h"

#include <renderer/film/points.h>
#include <renderer/film/render.h>

#include <probe/probe_maps.h>
#include <probe/read_probe.h>
#include <probe/rgbe.h>
#include <probe/synth.h>
#include <wavelet/base/parallel.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <set>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

/// A grey sphere over a grey plane, or alone, under a synthesised probe.
SceneDescription lambert_scene(const TemporaryFolder& folder, bool plane, bool white = false) {
  Image image = probe::draw_angular(*probe::make_scene(probe::SceneKind::Studio), 64);
  if (white)
    std::fill(image.rgb.begin(), image.rgb.end(), 1.0F);
  probe::write_rgbe(folder.file("probe.hdr"), image);
  SceneDescription scene;
  scene.path = "test";
  scene.camera.projection = CameraProjection::Orthographic;
  scene.camera.from = Vec3(0, 1, 5);
  scene.camera.height = 2.2;
  scene.light.probe = folder.file("probe.hdr");
  scene.light.mapping = "angular";
  MaterialDescription grey;
  grey.name = "grey";
  grey.lambert = Rgb(0.5F, 0.4F, 0.3F);
  scene.materials.push_back(grey);
  scene.objects.push_back({Sphere{}, {}, 0});
  if (plane)
    scene.objects.push_back({Plane{Vec3(0, -1, 0), Vec3::UnitY()}, {}, 0});
  return scene;
}

RenderResult render_with(const SceneDescription& description, const RenderOptions& options) {
  const LoadedScene scene(description, {}, options.sampler, needs_unshadowed(options.estimator));
  return render(scene, options, 24, 24);
}

double mean_of(const Film& film) {
  double sum = 0;
  for (const float value : film.rgb)
    sum += value;
  return sum / static_cast<double>(film.rgb.size());
}

} // namespace

TEST_CASE("Sobol points are nets: any aligned run of 2^k has one point in every elementary box") {
  for (const std::uint32_t key : {1U, 77U}) {
    std::vector<Vec2> points(16);
    fill_points(Points::Sobol, key, 32, points);
    for (int log_x = 0; log_x <= 4; ++log_x) {
      std::set<std::pair<int, int>> boxes;
      for (const Vec2& p : points)
        boxes.insert({static_cast<int>(p.x() * static_cast<float>(1 << log_x)),
                      static_cast<int>(p.y() * static_cast<float>(16 >> log_x))});
      CHECK(boxes.size() == 16);
    }
  }
}

TEST_CASE("sets of different keys are independent, point by point") {
  std::vector<Vec2> a(1024);
  std::vector<Vec2> b(1024);
  fill_points(Points::Sobol, 3, 0, a);
  fill_points(Points::Sobol, 4, 0, b);
  for (std::size_t run = 0; run < a.size(); run += 16) {
    std::set<int> columns;
    for (std::size_t i = run; i < run + 16; ++i)
      columns.insert(static_cast<int>(a[i].x() * 16));
    CHECK(columns.size() == 16);
  }
  int counts[4][4] = {};
  for (std::size_t i = 0; i < a.size(); ++i)
    ++counts[static_cast<int>(a[i].x() * 4)][static_cast<int>(b[i].x() * 4)];
  for (const auto& row : counts)
    for (const int count : row)
      CHECK(std::abs(count - 64) < 40); // sets of one order would meet in a few of these only
}

TEST_CASE("point sets differ by key and continue by index") {
  for (const Points kind : {Points::Random, Points::Sobol}) {
    std::vector<Vec2> whole(8);
    std::vector<Vec2> tail(4);
    std::vector<Vec2> other(8);
    fill_points(kind, 5, 0, whole);
    fill_points(kind, 5, 4, tail);
    fill_points(kind, 6, 0, other);
    CHECK(std::equal(tail.begin(), tail.end(), whole.begin() + 4));
    CHECK_FALSE(std::equal(other.begin(), other.end(), whole.begin()));
    for (const Vec2& p : whole)
      CHECK((p.minCoeff() >= 0 && p.maxCoeff() < 1));
  }
}

TEST_CASE("a white furnace shows the albedo, with every sampler and estimator") {
  const TemporaryFolder folder;
  const SceneDescription scene = lambert_scene(folder, false, true);
  for (const SamplerKind kind :
       {SamplerKind::Product, SamplerKind::Light, SamplerKind::Brdf, SamplerKind::Mis})
    for (const Estimator estimator :
         {Estimator::Unbiased, Estimator::Bidirectional, Estimator::Ratio}) {
      RenderOptions options;
      options.sampler = kind;
      options.estimator = estimator;
      options.spp = 64;
      if (validate(kind, estimator))
        continue;
      const Film film = render_with(scene, options).film;
      const Rgb centre = film.color(film.index(12, 12));
      INFO(sampler_name(kind) << ", " << estimator_name(estimator));
      CHECK((centre - Rgb(0.5F, 0.4F, 0.3F)).abs().maxCoeff() < 0.03F);
    }
}

TEST_CASE("samplers agree on a scene with shadows; the estimators that assume little stay close") {
  const TemporaryFolder folder;
  const SceneDescription scene = lambert_scene(folder, true);
  RenderOptions options;
  options.spp = 256;
  const double product = mean_of(render_with(scene, options).film);
  options.sampler = SamplerKind::Mis;
  CHECK(mean_of(render_with(scene, options).film) == Approx(product).epsilon(0.005));
  options.sampler = SamplerKind::Light;
  CHECK(mean_of(render_with(scene, options).film) == Approx(product).epsilon(0.01));
  options.sampler = SamplerKind::Product;
  options.estimator = Estimator::Ratio;
  CHECK(mean_of(render_with(scene, options).film) == Approx(product).epsilon(0.02));
  options.estimator = Estimator::Bidirectional;
  CHECK(mean_of(render_with(scene, options).film) == Approx(product).epsilon(0.05));
}

TEST_CASE("emission is visible and adds to reflected light") {
  const TemporaryFolder folder;
  SceneDescription scene = lambert_scene(folder, true);
  RenderOptions options;
  options.spp = 4;
  const Film dark = render_with(scene, options).film;
  scene.materials[0].emission = Rgb(1, 0, 3);
  const Film shining = render_with(scene, options).film;
  const std::size_t centre = dark.index(12, 12);
  CHECK((shining.color(centre) - dark.color(centre) - Rgb(1, 0, 3)).abs().maxCoeff() < 1e-5F);
  CHECK(shining.variance == dark.variance);
  scene.materials[0].lambert.reset();
  for (const SamplerKind kind : {SamplerKind::Product, SamplerKind::Brdf, SamplerKind::Mis}) {
    options.sampler = kind;
    const Film black = render_with(scene, options).film;
    CHECK((black.color(centre) == Rgb(1, 0, 3)).all());
  }
}

TEST_CASE("a Lambertian gets its table with rolls at load") {
  const TemporaryFolder folder;
  SceneDescription scene = lambert_scene(folder, true);
  probe::MapOptions map_options;
  map_options.size = 32;
  map_options.orientations = 8;
  {
    OutputFile file(folder.file("table.haar"));
    wavelet::compress_set(
        probe::ProbeMaps(probe::read_probe(scene.light.probe, probe::Mapping::Angular).probe,
                         map_options),
        {}, file);
    file.commit();
  }
  RenderOptions options;
  options.spp = 256;
  const double product = mean_of(render_with(scene, options).film);
  scene.light.table = folder.file("table.haar");
  options.sampler = SamplerKind::ProductTable;
  CHECK(mean_of(render_with(scene, options).film) == Approx(product).epsilon(0.01));
}

TEST_CASE("the variance estimate is the variance over seeds") {
  const TemporaryFolder folder;
  const SceneDescription scene = lambert_scene(folder, false);
  RenderOptions options;
  options.sampler = SamplerKind::Light;
  options.points = Points::Random;
  options.spp = 32;
  const LoadedScene loaded(scene, {}, options.sampler, false);
  double claimed = 0;
  double sum = 0;
  double square = 0;
  const int runs = 200;
  for (int i = 0; i < runs; ++i) {
    options.seed = static_cast<std::uint32_t>(i);
    const Film film = render(loaded, options, 3, 3).film;
    const double value = luminance(film.color(4));
    claimed += static_cast<double>(film.variance[4]) / runs;
    sum += value / runs;
    square += value * value / runs;
  }
  CHECK(claimed == Approx(square - sum * sum).epsilon(0.3)); // 200 runs know a variance to 10 %
}

TEST_CASE("pixels depend on scene and options alone, not on threads") {
  const TemporaryFolder folder;
  const SceneDescription scene = lambert_scene(folder, true);
  RenderOptions options;
  options.spp = 4;
  std::vector<float> first;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const RenderResult result = render_with(scene, options);
    if (first.empty())
      first = result.film.rgb;
    CHECK(result.film.rgb == first);
  }
  options.seed = 1;
  CHECK(render_with(scene, options).film.rgb != first);
}

TEST_CASE("a rotated light is the probe looked up in the opposite rotation") {
  const TemporaryFolder folder;
  SceneDescription scene = lambert_scene(folder, false);
  scene.camera.from = Vec3(0, 0, 5);
  RenderOptions options;
  options.spp = 512;
  const double front = mean_of(render_with(scene, options).film);
  scene.light.rotate = 90;
  scene.camera.from = Vec3(5, 0, 0); // where +z went
  CHECK(mean_of(render_with(scene, options).film) == Approx(front).epsilon(0.01));
}

TEST_CASE("a time limit adds passes that continue the point sets") {
  const TemporaryFolder folder;
  const SceneDescription scene = lambert_scene(folder, false);
  RenderOptions options;
  options.spp = 1;
  options.time_limit = 0.2;
  const RenderResult result = render_with(scene, options);
  CHECK(result.statistics.spp > 1);
  CHECK(result.film.samples[12 * 24 + 12] == static_cast<float>(result.statistics.spp));
}
