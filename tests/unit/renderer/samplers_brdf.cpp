#include "sampler_checks.h"

#include <renderer/film/render.h>

#include <brdf/factored_brdf.h>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

struct NamedModel {
  const char* name;
  brdf::AnalyticBrdf model;
};

std::vector<NamedModel> models() {
  const Rgb matt(0.3F, 0.2F, 0.1F);
  const Rgb half = Rgb::Constant(0.4F);
  return {{"ggx", brdf::Ggx{matt, Rgb::Constant(0.04F), 0.2}},
          {"blinn-phong", brdf::BlinnPhong{matt, half, 40}},
          {"ward", brdf::Ward{Rgb::Zero(), half, 0.25}},
          {"lafortune", brdf::Lafortune{matt, half, 20, -0.9, 1}},
          {"ashikhmin-shirley", brdf::AshikhminShirley{matt, half, 60}}};
}

/// The fixture's sphere under the studio, of a model instead of files.
SceneDescription scene_of(const NamedModel& named) {
  SceneDescription scene = fixture().scene("rough", "studio");
  MaterialDescription material;
  material.name = named.name;
  material.model = named.model;
  scene.materials = {material};
  return scene;
}

double total_luminance(const Film& film) {
  double sum = 0;
  for (std::size_t i = 0; i < film.variance.size(); ++i)
    sum += static_cast<double>(luminance(film.color(i)));
  return sum;
}

/// Share of the film's luminance that two pictures differ by, pixel by pixel.
double difference(const Film& a, const Film& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.variance.size(); ++i)
    sum += static_cast<double>(luminance((a.color(i) - b.color(i)).abs()));
  return sum / total_luminance(a);
}

brdf::FactoredBrdf factored(const brdf::AnalyticBrdf& model) {
  return brdf::FactoredBrdf([&](const Vec3& wo, std::span<const Vec3> directions,
                                std::span<float> out) {
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] =
          luminance(brdf::evaluate(model, directions[i], wo)) * std::max(0.0F, directions[i].z());
  });
}

} // namespace

TEST_CASE("factored sampling agrees with brute-force quadrature") {
  constexpr SamplerKind kinds[] = {SamplerKind::Factored};
  check_unbiased(kinds, 1);
}

TEST_CASE("factored sampling draws what its pdf says") {
  constexpr SamplerKind kinds[] = {SamplerKind::Factored};
  check_densities(kinds);
}

TEST_CASE("analytic materials are sampled without bias, with the density stated") {
  int strays = 0;
  std::uint32_t key = 5000;
  for (const NamedModel& named : models()) {
    for (const SamplerKind kind : {SamplerKind::Brdf, SamplerKind::Mis}) {
      strays += count_strays(scene_of(named), kind, named.name, key);
      key += 6;
    }
    check_density(scene_of(named), SamplerKind::Brdf, named.name, key++);
  }
  CHECK(strays <= 3);
  const LoadedScene scene(scene_of(models()[0]), {}, SamplerKind::Brdf, false);
  CHECK_FALSE(scene.materials()[0].has_trees());
}

TEST_CASE("every material can be factorised") {
  SceneDescription scene = fixture().scene("glossy", "studio");
  scene.materials[0].brdf.clear();
  CHECK(count_strays(scene, SamplerKind::Factored, "trees alone", 7000) <= 1);
  MaterialDescription grey;
  grey.lambert = Rgb(0.5F, 0.4F, 0.3F);
  scene.materials = {grey};
  CHECK(count_strays(scene, SamplerKind::Factored, "Lambertian", 7010) <= 1);
  grey.lambert = Rgb::Zero();
  scene.materials = {grey};
  const LoadedScene black(scene, {}, SamplerKind::Factored, false);
  const auto sampler = make_sampler_factory(SamplerKind::Factored, black, {})->make(16);
  sampler->prepare(shading_points()[0], black.materials()[0]);
  std::vector<DirectionSample> samples(1000);
  sampler->sample({Points::Random, 1, 0}, samples);
  CHECK(std::ranges::all_of(samples, [](const DirectionSample& s) {
    return std::isfinite(s.pdf) && s.pdf > 0 && s.direction.allFinite();
  }));
}

TEST_CASE("factors follow the reflectance: weights of samples vary little") {
  // f cos / pdf would be the albedo for every sample of a perfect density.
  for (const NamedModel& named : models()) {
    const brdf::FactoredBrdf factors = factored(named.model);
    for (const float cos_o : {0.95F, 0.6F, 0.3F}) {
      const Vec3 wo(std::sqrt(1 - cos_o * cos_o), 0, cos_o);
      const auto view = factors.view(wo);
      std::vector<Vec2> points(8192);
      fill_points(Points::Sobol, 3, 0, points);
      double sum = 0;
      double square = 0;
      for (const Vec2& u : points) {
        const auto s = factors.sample(view, u);
        const double value =
            static_cast<double>(luminance(brdf::evaluate(named.model, s.direction, wo)) *
                                std::max(0.0F, s.direction.z()) / s.pdf);
        sum += value / 8192;
        square += value * value / 8192;
      }
      INFO(named.name << " from cosine " << cos_o);
      CHECK(square / (sum * sum) - 1 < 0.5);
    }
  }
}

TEST_CASE("a sphere of each model looks the same with every sampler") {
  for (const NamedModel& named : models()) {
    SceneDescription description = scene_of(named);
    description.camera.from = Vec3(0, 0, 6);
    RenderOptions options;
    options.spp = 4096;
    options.sampler = SamplerKind::Mis;
    const LoadedScene mis(description, {}, options.sampler, false);
    const Film truth = render(mis, options, 12, 12).film;
    for (const SamplerKind kind : {SamplerKind::Brdf, SamplerKind::Factored}) {
      options.sampler = kind;
      const LoadedScene scene(description, {}, kind, false);
      INFO(named.name << " with " << sampler_name(kind));
      const Film film = render(scene, options, 12, 12).film;
      CHECK(difference(truth, film) < 0.03); // noise of small lights, nearly all of it
      CHECK(total_luminance(film) == Approx(total_luminance(truth)).epsilon(0.015));
    }
  }
}

TEST_CASE("trees of a model are built when a sampler needs them") {
  SceneDescription description = scene_of(models()[1]);
  CHECK(count_strays(description, SamplerKind::Product, "blinn-phong", 8000) <= 1);
  description.light.table = fixture().scene("rough", "studio").light.table;
  CHECK(count_strays(description, SamplerKind::ProductTable, "blinn-phong", 8010) <= 1);
}
