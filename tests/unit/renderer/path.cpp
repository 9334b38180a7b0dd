// Paths: furnaces, a brute-force path tracer, and the parts they are made of.

#include "path/emitters.h"
#include "sampler_fixture.h"
#include "samplers/basic_samplers.h"
#include "temporary_folder.h"

#include <renderer/path/path.h>

#include <probe/rgbe.h>
#include <probe/synth.h>
#include <wavelet/base/parallel.h>

#include <catch2/catch.hpp>

#include <random>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

/// A camera in front of the origin under a probe; materials and objects are to be added.
class PathScene {
public:
  explicit PathScene(float white = 0) {
    Image image = probe::draw_angular(*probe::make_scene(probe::SceneKind::Studio), 32);
    for (float& value : image.rgb)
      value = white > 0 ? white : std::min(value, 2.0F); // brute force wants no small bright lamps
    probe::write_rgbe(m_folder->file("probe.hdr"), image);
    scene.path = "test";
    scene.camera.from = Vec3(0, 1, 6);
    scene.light.probe = m_folder->file("probe.hdr");
    scene.light.mapping = "angular";
  }

  int lambert(float albedo, float emission = 0) {
    MaterialDescription material;
    material.lambert = Rgb::Constant(albedo);
    material.emission = Rgb::Constant(emission);
    return add(material);
  }
  int ggx(float diffuse, float specular, double roughness) {
    brdf::Ggx model;
    model.diffuse = Rgb::Constant(diffuse);
    model.specular = Rgb::Constant(specular);
    model.roughness = roughness;
    MaterialDescription material;
    material.model = model;
    return add(material);
  }
  /// A measurement of a matt surface.
  int measured(float albedo) {
    brdf::BlinnPhong model;
    model.diffuse = Rgb::Constant(albedo);
    model.specular = Rgb::Zero();
    MaterialDescription material;
    material.brdf = m_folder->file("measured.binary");
    brdf::write_merl(material.brdf, brdf::tabulate(model));
    material.haar = m_folder->file("measured.haar");
    brdf::BrdfMapOptions options;
    options.size = 64;
    options.theta = 16;
    write_haar(material.haar, brdf::BrdfMaps(brdf::MeasuredBrdf(material.brdf), options));
    return add(material);
  }
  void object(const Shape& shape, int material, const AffineMap& transform = {}) {
    scene.objects.push_back({shape, transform, material});
  }

  /// For paths with the samplers product and mis.
  LoadedScene load() const {
    return LoadedScene(scene, {}, SamplerKind::Product, false, path_needs);
  }

  SceneDescription scene;

private:
  int add(MaterialDescription material) {
    material.name = std::to_string(scene.materials.size());
    scene.materials.push_back(material);
    return static_cast<int>(scene.materials.size()) - 1;
  }

  std::unique_ptr<TemporaryFolder> m_folder = std::make_unique<TemporaryFolder>();
};

struct Mean {
  double value = 0;
  double error = 0; ///< standard
};

/// Mean luminance of a film of paths.
Mean mean_of(const Film& film) {
  Mean mean;
  for (std::size_t i = 0; i < film.count(); ++i) {
    mean.value += static_cast<double>(luminance(film.color(i)));
    mean.error += static_cast<double>(film.variance[i]);
  }
  const auto n = static_cast<double>(film.count());
  return {mean.value / n, std::sqrt(mean.error) / n};
}

RenderOptions options_of(SamplerKind sampler, int spp) {
  RenderOptions options;
  options.sampler = sampler;
  options.spp = spp;
  return options;
}

Mean path_mean(const LoadedScene& scene, const PathOptions& path, SamplerKind sampler, int spp,
               int side) {
  return mean_of(render_paths(scene, options_of(sampler, spp), path, side, side).film);
}

/// Every direction of the upper hemisphere alike, no light looked for: nothing to get wrong.
class BruteForce {
public:
  BruteForce(const LoadedScene& scene, int depth) : m_scene(scene), m_depth(depth) {}

  Mean film_mean(int side, int paths) {
    const Camera camera(m_scene.description().camera, side, side);
    double sum = 0;
    double variance = 0;
    for (int i = 0; i < side * side; ++i) {
      const Ray ray = camera.generate_ray(static_cast<float>(i % side) + 0.5F,
                                          static_cast<float>(i / side) + 0.5F); // NOLINT
      double mean = 0;
      double square = 0;
      for (int k = 0; k < paths; ++k) {
        const double y = luminance(radiance(ray, 0));
        mean += y / paths;
        square += y * y / paths;
      }
      sum += mean;
      variance += std::max(0.0, square - mean * mean) / paths;
    }
    return {sum / (side * side), std::sqrt(variance) / (side * side)};
  }

private:
  Rgb radiance(const Ray& ray, int vertices) {
    Hit hit;
    if (!m_scene.shapes().intersect(ray, hit))
      return m_scene.light().radiance(m_scene.light().to_light(ray.direction));
    const Material& material = m_scene.material_of(hit.object);
    Rgb sum = material.emission();
    if (vertices == m_depth)
      return sum;
    if (hit.normal.dot(ray.direction) > 0)
      hit.normal = -hit.normal;
    const Vec3 w = upwards(hit.normal);
    const Light& light = m_scene.light();
    const ShadingPoint point =
        shading_point(light.to_light(hit.normal), light.to_light(-ray.direction));
    const Rgb weight = material.evaluate(point, light.to_light(w)) * (2 * pi);
    if ((weight > 0).any())
      sum += weight * radiance(leave(hit, w), vertices + 1);
    return sum;
  }

  Vec3 upwards(const Vec3& normal) {
    Vec3 v;
    do
      v = Vec3(uniform(), uniform(), uniform()) * 2 - Vec3::Ones();
    while (v.squaredNorm() > 1 || v.squaredNorm() < 1e-4F);
    v.normalize();
    return v.dot(normal) < 0 ? Vec3(-v) : v;
  }
  float uniform() { return std::uniform_real_distribution<float>()(m_random); }

  const LoadedScene& m_scene;
  int m_depth;
  std::mt19937 m_random{7};
};

PathScene under_studio() {
  PathScene scene;
  scene.scene.light.rotate = 40;
  const int floor = scene.lambert(0.7F);
  const int glossy = scene.ggx(0.3F, 0.3F, 0.4);
  scene.object(Plane{Vec3(0, -1, 0), Vec3::UnitY()}, floor);
  scene.object(Sphere{}, glossy);
  scene.object(Box{Vec3(1.2F, -1, 0.2F), Vec3(2, 0.3F, 1)}, glossy);
  return scene;
}

PathScene with_lamps() {
  PathScene scene(0.05F);
  const int wall = scene.lambert(0.8F);
  const int lamp = scene.lambert(0.2F, 3);
  scene.object(Plane{Vec3(0, -1, 0), Vec3::UnitY()}, wall);
  scene.object(Sphere{Vec3(-1.2F, 0.4F, 0), 0.7F}, lamp);
  scene.object(Sphere{Vec3(1.6F, 1.2F, -1), 0.5F}, lamp);
  scene.object(Box{Vec3(-0.4F, -1, -0.4F), Vec3(0.6F, 0.2F, 0.6F)}, wall,
               rotation(Eigen::Vector3d::UnitY(), 30));
  return scene;
}

PathScene with_flat_lamps() {
  PathScene scene(0.1F);
  const int wall = scene.measured(0.6F);
  const int lamp = scene.lambert(0.5F, 2);
  const AffineMap skewed = rotation(Eigen::Vector3d(1, 2, 3), 50).then(scaling({1, 0.5, 1.5}));
  scene.object(Plane{Vec3(0, -1, 0), Vec3::UnitY()}, wall);
  scene.object(Disk{Vec3(-0.6F, 1.8F, 0), Vec3(0.3F, -1, 0.2F), 0.8F}, lamp);
  scene.object(Box{Vec3(-0.4F, -0.4F, -0.4F), Vec3(0.4F, 0.4F, 0.4F)}, lamp,
               skewed.then(translation({1.2, 0.2, 0.5})));
  scene.object(Cylinder{Vec3(-1, -1, 0), Vec3(-1, 0.3F, 0), 0.5F}, lamp);
  scene.object(Sphere{Vec3(0, -0.4F, 1), 0.6F}, wall);
  return scene;
}

} // namespace

TEST_CASE("in white furnaces everything is as bright as the furnace") {
  PathScene matt(1);
  const int white = matt.lambert(1);
  matt.object(Sphere{}, white);
  matt.object(Cylinder{Vec3(1.5F, -1, 0), Vec3(1.2F, 1, 0), 0.4F}, white);
  matt.object(Disk{Vec3(0, -1.2F, 0), Vec3::UnitY(), 2}, white);
  PathScene table(1);
  const int measured = table.measured(1);
  table.object(Sphere{}, measured);
  table.object(Disk{Vec3(0, -1, 0), Vec3::UnitY(), 2}, measured);
  for (const PathScene* scene : {&matt, &table}) {
    const LoadedScene loaded = scene->load();
    for (const SamplerKind sampler : {SamplerKind::Mis, SamplerKind::Product}) {
      const Mean mean = path_mean(loaded, {}, sampler, 4000, 10);
      INFO(sampler_name(sampler) << " ± " << mean.error);
      CHECK(mean.error < 0.001);
      CHECK(mean.value == Approx(1).epsilon(0.002));
    }
  }
}

TEST_CASE("in closed furnaces what is emitted and what is reflected add up") {
  PathScene hollow(8); // whose light must not come in
  const int quarter = hollow.lambert(0.25F, 0.75F);
  hollow.scene.camera.from = Vec3(0, 0.5F, 2);
  hollow.object(Sphere{Vec3::Zero(), 5}, quarter);
  const Mean alone = path_mean(hollow.load(), {}, SamplerKind::Mis, 2048, 8);
  CHECK(alone.error < 0.0007);
  CHECK(alone.value == Approx(1).epsilon(0.002));
  hollow.object(Sphere{}, quarter);
  hollow.object(Box{Vec3(-2, -1, -1), Vec3(-1.2F, 0, 0)}, quarter);
  hollow.object(Disk{Vec3(1.5F, 0, 0), Vec3(1, 1, 1), 0.8F}, quarter);
  hollow.object(Cone{Vec3(0, -2, 0), Vec3(0.3F, -1.2F, 0), 1}, quarter);
  const Mean furnished = path_mean(hollow.load(), {}, SamplerKind::Product, 1024, 12);
  CHECK(furnished.error < 0.0007);
  CHECK(furnished.value == Approx(1).epsilon(0.002));
}

TEST_CASE("paths find what brute force finds") {
  const PathScene scenes[] = {under_studio(), with_lamps(), with_flat_lamps()};
  for (const PathScene& scene : scenes) {
    const LoadedScene loaded = scene.load();
    for (const int depth : {1, 3}) {
      const Mean truth = BruteForce(loaded, depth).film_mean(8, 2000);
      CHECK(truth.error < 0.01 * truth.value);
      for (const SamplerKind sampler : {SamplerKind::Mis, SamplerKind::Product}) {
        const Mean mean = path_mean(loaded, {depth, 2}, sampler, 128, 8);
        INFO(&scene - scenes << ", depth " << depth << ", " << sampler_name(sampler) << ": "
                             << mean.value << " ± " << mean.error << " for " << truth.value << " ± "
                             << truth.error);
        CHECK(std::abs(mean.value - truth.value) < 4 * std::hypot(mean.error, truth.error));
        CHECK(mean.error < 0.01 * mean.value);
      }
    }
  }
}

TEST_CASE("without a bound on depth roulette loses nothing") {
  const PathScene lamps = with_lamps();
  const LoadedScene scene = lamps.load();
  const Mean truth = BruteForce(scene, 40).film_mean(8, 4000);
  const Mean free = path_mean(scene, {}, SamplerKind::Mis, 2048, 8);
  INFO(free.value << " ± " << free.error << " for " << truth.value << " ± " << truth.error);
  CHECK(std::abs(free.value - truth.value) < 4 * std::hypot(free.error, truth.error));
  CHECK(truth.error < 0.01 * truth.value);
}

TEST_CASE("directions to emitters have the density they claim, and weights add up to one") {
  const PathScene scenes[] = {with_lamps(), with_flat_lamps()};
  for (const PathScene& scene : scenes) {
    const LoadedScene loaded = scene.load();
    const Emitters emitters(scene.scene);
    Hit floor;
    REQUIRE(loaded.shapes().intersect({Vec3(0.2F, 5, 1.9F), -Vec3::UnitY()}, floor));
    Lobe lobe;
    const ShadingPoint point = shading_point(floor.normal, Vec3(0.6F, 0.8F, 0));
    lobe.prepare(point, loaded.material_of(floor.object));
    const int n = 40000;
    std::vector<Vec2> points(n);
    std::vector<Vec2> choices(n);
    fill_points(Points::Sobol, 1, 0, points);
    fill_points(Points::Sobol, 2, 0, choices);
    float most_off = 0;
    double claimed = 0;
    double seen = 0;
    for (std::size_t i = 0; i < n; ++i) {
      Hit hit;
      const auto to = emitters.sample(floor, choices[i].x(), points[i]);
      if (!to)
        continue;
      most_off = std::max(most_off, std::abs(to->direction.norm() - 1));
      if (loaded.shapes().intersect(leave(floor, to->direction), hit) && hit.object == to->object) {
        const float pdf = emitters.pdf(floor, to->direction, hit);
        const float other = lobe.pdf(to->direction);
        most_off = std::max(
            most_off, std::abs(balance_heuristic(pdf, other) + balance_heuristic(other, pdf) - 1));
        claimed += 1 / static_cast<double>(pdf) / n;
      }
      const float z = 1 - 2 * points[i].x(); // uniform over the sphere
      const float phi = 2 * pi * points[i].y();
      const float r = std::sqrt(1 - z * z);
      const Vec3 w(r * std::cos(phi), z, r * std::sin(phi));
      if (loaded.shapes().intersect(leave(floor, w), hit) && emitters.pdf(floor, w, hit) > 0)
        seen += 4 * static_cast<double>(pi) / n;
    }
    CHECK(most_off < 1e-5F);
    CHECK(claimed == Approx(seen).epsilon(0.015)); // solid angle of what is seen of the emitters
  }
}

TEST_CASE("nothing samples an emitter from inside, from itself or from below the horizon") {
  PathScene scene;
  const int lamp = scene.lambert(0.5F, 1);
  scene.object(Sphere{}, lamp);
  const Emitters emitters(scene.scene);
  Hit hit;
  hit.position = Vec3(0, 2, 0);
  hit.normal = Vec3::UnitY();
  hit.object = 1;
  CHECK_FALSE(emitters.sample(hit, 0.5F, Vec2(0.5F, 0.5F)));
  hit.normal = -Vec3::UnitY();
  CHECK(emitters.sample(hit, 0.5F, Vec2(0.5F, 0.5F)));
  hit.position = Vec3(0, 0.5F, 0);
  CHECK_FALSE(emitters.sample(hit, 0.5F, Vec2(0.5F, 0.5F)));
  hit.position = Vec3(0, 1, 0);
  hit.object = 0;
  CHECK_FALSE(emitters.sample(hit, 0.5F, Vec2(0.5F, 0.5F)));
}

TEST_CASE("paths of one vertex without emitters are direct light") {
  const PathScene scene = under_studio();
  const LoadedScene loaded = scene.load();
  const RenderOptions options = options_of(SamplerKind::Product, 4);
  const Film direct = render(loaded, options, 24, 24).film;
  CHECK(render_paths(loaded, options, {1}, 24, 24).film.rgb == direct.rgb);
  CHECK(render_paths(loaded, options, {2}, 24, 24).film.rgb != direct.rgb);
}

TEST_CASE("paths depend on scene and options alone, not on threads") {
  const LoadedScene scene = with_lamps().load();
  const RenderOptions options = options_of(SamplerKind::Product, 4);
  std::vector<float> first;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const Film film = render_paths(scene, options, {}, 24, 24).film;
    if (first.empty())
      first = film.rgb;
    CHECK(film.rgb == first);
  }
}
