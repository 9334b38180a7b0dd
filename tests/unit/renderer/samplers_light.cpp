// Samplers that follow the light alone: the alias table, and lights in place of regions.

#include "sampler_checks.h"

#include <algorithm>
#include <numeric>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr SamplerKind alias_kinds[] = {SamplerKind::Alias};
constexpr SamplerKind lamp_kinds[] = {SamplerKind::MedianCut, SamplerKind::KolligKeller,
                                      SamplerKind::Structured, SamplerKind::Ostromoukhov};

/// A grey sphere under a probe of 64 × 64 pixels.
SceneDescription scene_under(const std::string& probe) {
  SceneDescription scene;
  scene.path = "test";
  scene.light.probe = probe;
  scene.light.mapping = "angular";
  MaterialDescription grey;
  grey.name = "grey";
  grey.lambert = Rgb(0.5F, 0.5F, 0.5F);
  scene.materials.push_back(grey);
  scene.objects.push_back({Sphere{}, {}, 0});
  return scene;
}

/// RepresentativeLights of a scene's light, as the renderer sees them.
struct RepresentativeLights {
  RepresentativeLights(const SceneDescription& description, SamplerKind kind, std::size_t count)
      : scene(description, {}, kind, false), samples(count), radiance(count), energy(count) {
    SamplerOptions options;
    options.count = count;
    const auto sampler = make_sampler_factory(kind, scene, options)->make(16);
    sampler->prepare(shading_points()[0], scene.materials()[0]);
    sampler->sample({Points::Sobol, 1, 0}, samples);
    std::vector<Vec3> directions;
    for (const DirectionSample& s : samples)
      directions.push_back(s.direction);
    sampler->radiance(scene.light(), directions, radiance);
    for (std::size_t i = 0; i < count; ++i)
      energy[i] =
          samples[i].pdf > 0 ? static_cast<double>(luminance(radiance[i])) * solid_angle(i) : 0;
  }

  double solid_angle(std::size_t i) const {
    return 1 / (static_cast<double>(samples.size()) * static_cast<double>(samples[i].pdf));
  }

  double whole() const { return std::accumulate(energy.begin(), energy.end(), 0.0); }

  std::ptrdiff_t lit() const {
    return std::count_if(energy.begin(), energy.end(), [](double e) { return e > 0; });
  }

  LoadedScene scene;
  std::vector<DirectionSample> samples;
  std::vector<Rgb> radiance;
  std::vector<double> energy; ///< luminance × solid angle
};

/// Writes a probe that is uniform but for one pixel.
std::string uniform_probe(const TemporaryFolder& folder, float value, float bright) {
  Image image(64, 64);
  std::fill(image.rgb.begin(), image.rgb.end(), value);
  image.set(40, 21, Rgb::Constant(bright));
  std::string path = folder.file("uniform.hdr");
  probe::write_rgbe(path, image);
  return path;
}

double power_of(const SceneDescription& description) {
  return static_cast<double>(luminance(probe_of(description).integral()));
}

/// Least angle between two lights, radians.
double least_distance(const RepresentativeLights& lights) {
  float most = -1;
  for (std::size_t i = 0; i < lights.samples.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      most = std::max(most, lights.samples[i].direction.dot(lights.samples[j].direction));
  return std::acos(std::min(1.0, static_cast<double>(most)));
}

} // namespace

TEST_CASE("the alias table agrees with brute-force quadrature") { check_unbiased(alias_kinds, 1); }

TEST_CASE("the alias table draws what its pdf says") { check_densities(alias_kinds); }

TEST_CASE("the alias table and the cdf draw with one density") {
  const SceneDescription description = fixture().scene("rough", "studio");
  const LoadedScene scene(description, {}, SamplerKind::Alias, false);
  const auto alias = make_sampler_factory(SamplerKind::Alias, scene, {})->make(16);
  const auto cdf = make_sampler_factory(SamplerKind::Light, scene, {})->make(16);
  std::vector<DirectionSample> samples(1000);
  alias->sample({Points::Sobol, 3, 0}, samples);
  std::size_t different = 0;
  for (const DirectionSample& s : samples)
    different += std::abs(cdf->pdf(s.direction, 1) / s.pdf - 1) > 1e-3F ? 1 : 0;
  // Points on a pixel's very edge may round into the next.
  CHECK(different < 5);
}

TEST_CASE("representative lights keep the light's energy, however many") {
  for (const char* probe : {"studio", "spheres"}) {
    const SceneDescription description = fixture().scene("rough", probe);
    const double power = power_of(description);
    for (const SamplerKind kind : lamp_kinds)
      for (const std::size_t count : {1U, 2U, 7U, 64U, 300U}) {
        const RepresentativeLights lights(description, kind, count);
        INFO(probe << ", " << count << " lights of " << sampler_name(kind));
        CHECK(lights.whole() == Approx(power).epsilon(2e-3));
        CHECK(lights.lit() == static_cast<std::ptrdiff_t>(count));
      }
  }
}

TEST_CASE("with many representative lights the reflected light is what it should be") {
  const SceneDescription description = fixture().scene("rough", "studio");
  const probe::Probe source = probe_of(description);
  for (const SamplerKind kind : lamp_kinds) {
    const auto error = [&](std::size_t count) {
      const RepresentativeLights lights(description, kind, count);
      double difference = 0;
      double sum = 0;
      for (const ShadingPoint& point : shading_points()) {
        const double truth = quadrature(lights.scene, point, source);
        double estimate = 0;
        for (std::size_t i = 0; i < count; ++i)
          estimate +=
              lights.energy[i] * static_cast<double>(luminance(lights.scene.materials()[0].evaluate(
                                     point, lights.samples[i].direction)));
        difference += std::abs(estimate - truth);
        sum += truth;
      }
      return difference / sum;
    };
    const double few = error(8);
    const double many = error(2048);
    INFO(sampler_name(kind) << ": " << few << " with 8, " << many << " with 2048");
    CHECK(many < 0.02);
    CHECK(many < few);
  }
}

TEST_CASE("every probe has representative lights: black but for a pixel, all equal, faint; one "
          "light or many") {
  const TemporaryFolder folder;
  const std::pair<float, float> probes[] = {{0, 1000}, {1, 1}, {1, 1e6F}, {1e-20F, 1e-20F}};
  for (const auto& [value, bright] : probes) {
    const SceneDescription description = scene_under(uniform_probe(folder, value, bright));
    const double power = power_of(description);
    for (const SamplerKind kind : lamp_kinds)
      for (const std::size_t count : {1U, 5U, 200U}) {
        const RepresentativeLights lights(description, kind, count);
        INFO(value << " and " << bright << ", " << count << " lights of " << sampler_name(kind));
        CHECK(lights.whole() == Approx(power).epsilon(2e-3));
        for (const DirectionSample& s : lights.samples) {
          REQUIRE(s.direction.norm() == Approx(1).epsilon(1e-4));
          REQUIRE(std::isfinite(s.pdf));
        }
      }
  }
}

TEST_CASE("a light that is a tree alone is sampled too") {
  SceneDescription description = fixture().scene("rough", "studio");
  const double power = power_of(description);
  description.light.probe.clear();
  for (const SamplerKind kind : lamp_kinds)
    CHECK(RepresentativeLights(description, kind, 64).whole() == Approx(power).epsilon(0.02));
  CHECK(RepresentativeLights(description, SamplerKind::Alias, 4096).whole() ==
        Approx(power).epsilon(0.02));
}

TEST_CASE("median cut gives representative lights equal shares, of powers of two and in between") {
  const SceneDescription description = fixture().scene("rough", "studio");
  for (const std::size_t count : {16U, 64U}) {
    const RepresentativeLights lights(description, SamplerKind::MedianCut, count);
    const double mean = lights.whole() / static_cast<double>(count);
    const auto [least, most] = std::minmax_element(lights.energy.begin(), lights.energy.end());
    INFO(count << " lights, " << *least / mean << " to " << *most / mean);
    CHECK(*least > 0.75 * mean);
    CHECK(*most < 1.25 * mean);
  }
  const RepresentativeLights lights(description, SamplerKind::MedianCut, 24);
  const auto [least, most] = std::minmax_element(lights.energy.begin(), lights.energy.end());
  CHECK(*most < 2.2 * *least);
}

TEST_CASE("representative lights of a uniform sky are spread evenly") {
  const TemporaryFolder folder;
  const SceneDescription description = scene_under(uniform_probe(folder, 1, 1));
  constexpr std::size_t count = 128;
  // Centres of 128 cells in the densest possible packing are 0.336 apart.
  const std::pair<SamplerKind, double> least[] = {{SamplerKind::MedianCut, 0.1},
                                                  {SamplerKind::KolligKeller, 0.2},
                                                  {SamplerKind::Structured, 0.16},
                                                  {SamplerKind::Ostromoukhov, 0.08}};
  for (const auto& [kind, distance] : least) {
    const RepresentativeLights lights(description, kind, count);
    INFO(sampler_name(kind));
    CHECK(least_distance(lights) > distance);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i)
      sum += static_cast<float>(lights.energy[i] / lights.whole()) * lights.samples[i].direction;
    CHECK(sum.norm() < 0.06F);
  }
}

TEST_CASE(
    "structured representative lights are shared by energy and the fourth root of solid angle") {
  const TemporaryFolder folder;
  // A small disk as strong as the rest of the sky.
  Image image(64, 64);
  std::fill(image.rgb.begin(), image.rgb.end(), 1.0F);
  for (int y = 30; y < 34; ++y)
    for (int x = 20; x < 24; ++x)
      image.set(x, y, Rgb::Constant(200));
  probe::write_rgbe(folder.file("disk.hdr"), image);
  const SceneDescription description = scene_under(folder.file("disk.hdr"));
  const probe::Probe source = probe_of(description);
  double solid_angle = 0;
  for (int y = 30; y < 34; ++y)
    for (int x = 20; x < 24; ++x)
      solid_angle += source.pixel_solid_angle(x, y);
  const double disk = 200 * solid_angle * std::pow(std::min(solid_angle, 0.01), 0.25);
  const double sky = (4 * std::numbers::pi - solid_angle) * std::pow(0.01, 0.25);
  constexpr std::size_t count = 100;
  const RepresentativeLights lights(description, SamplerKind::Structured, count);
  double in_disk = 0;
  for (const DirectionSample& s : lights.samples)
    in_disk += luminance(source.radiance(s.direction)) > 100 ? 1 : 0;
  INFO(in_disk << " of " << count << " lights, expected " << count * disk / (disk + sky));
  // The map's pixels along the disk's edge are strata of their own, between both.
  CHECK(in_disk == Approx(count * disk / (disk + sky)).margin(8));
}

TEST_CASE("more representative lights of the tiling take in the fewer, all of one energy") {
  const SceneDescription description = fixture().scene("rough", "spheres");
  const RepresentativeLights few(description, SamplerKind::Ostromoukhov, 60);
  const RepresentativeLights many(description, SamplerKind::Ostromoukhov, 500);
  for (std::size_t i = 0; i < few.samples.size(); ++i)
    CHECK(few.samples[i].direction == many.samples[i].direction);
  for (const double energy : many.energy)
    CHECK(energy == Approx(many.whole() / 500).epsilon(1e-3));
}

TEST_CASE("representative lights are the same at every point, and of any count at any time") {
  const LoadedScene scene(fixture().scene("rough", "studio"), {}, SamplerKind::KolligKeller, false);
  const auto factory = make_sampler_factory(SamplerKind::KolligKeller, scene, {});
  const auto one = factory->make(16);
  const auto other = factory->make(16);
  for (const std::size_t count : {16U, 4U, 16U}) {
    std::vector<DirectionSample> a(count);
    std::vector<DirectionSample> b(count);
    one->prepare(shading_points()[0], scene.materials()[0]);
    one->sample({Points::Random, 1, 0}, a);
    other->prepare(shading_points()[4], scene.materials()[0]);
    other->sample({Points::Sobol, 2, 32}, b);
    for (std::size_t i = 0; i < count; ++i) {
      CHECK(a[i].direction == b[i].direction);
      CHECK(one->pdf(a[i].direction, count) == a[i].pdf);
    }
  }
}
