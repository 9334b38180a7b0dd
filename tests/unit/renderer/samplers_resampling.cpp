#include "sampler_checks.h"

#include <algorithm>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr std::size_t runs = 512;
constexpr std::size_t few_samples = 4;

/// One of the eight octants of the sphere: a visibility that resampling knows nothing of.
int octant(const Vec3& w) {
  return (w.x() < 0 ? 1 : 0) + (w.y() < 0 ? 2 : 0) + (w.z() < 0 ? 4 : 0);
}

struct Octants {
  double value[8] = {};
};

Octants octant_truth(const LoadedScene& scene, const ShadingPoint& point,
                     const probe::Probe& probe) {
  Octants result;
  for_each_point(probe, 4, [&](const Vec3& w, double omega) {
    result.value[octant(w)] += omega * integrand(scene, point, w);
  });
  return result;
}

/// What few samples say of each octant.
Octants estimate_octants(const LoadedScene& scene, Sampler& sampler, const ShadingPoint& point,
                         std::uint32_t key, Points kind) {
  std::vector<DirectionSample> samples(few_samples);
  sampler.sample({kind, key, 0}, samples);
  Octants result;
  for (const DirectionSample& s : samples)
    if (s.pdf > 0)
      result.value[octant(s.direction)] +=
          integrand(scene, point, s.direction) / static_cast<double>(s.pdf) / few_samples;
  return result;
}

struct Means {
  Octants mean;
  Octants error;
};

Means mean_octants(const LoadedScene& scene, Sampler& sampler, const ShadingPoint& point,
                   std::uint32_t key, Points kind) {
  Octants sum;
  Octants square;
  for (std::uint32_t run = 0; run < runs; ++run) {
    const Octants one = estimate_octants(scene, sampler, point, hash_words(key, run), kind);
    for (int i = 0; i < 8; ++i) {
      sum.value[i] += one.value[i] / runs;
      square.value[i] += one.value[i] * one.value[i] / runs;
    }
  }
  Means result;
  result.mean = sum;
  for (int i = 0; i < 8; ++i)
    result.error.value[i] =
        std::sqrt(std::max(0.0, square.value[i] - sum.value[i] * sum.value[i]) / runs);
  return result;
}

/// The octants' means of many short runs against quadrature, in standard deviations where they
/// matter, the worst first.
/// @param tolerance relative error that is no deviation yet; quadrature's own is about 0.1 %
std::vector<double> deviations(SamplerKind sampler_kind, const char* material, Points kind,
                               double tolerance = 2e-3) {
  const SceneDescription description = fixture().scene(material, "studio");
  const probe::Probe source = probe_of(description);
  const LoadedScene scene(description, {}, sampler_kind, false);
  const auto sampler = make_sampler_factory(sampler_kind, scene, {})->make(16);
  std::vector<double> result;
  std::uint32_t key = 1;
  for (const ShadingPoint& point : shading_points()) {
    sampler->prepare(point, scene.materials()[0]);
    const Octants truth = octant_truth(scene, point, source);
    const auto [mean, error] = mean_octants(scene, *sampler, point, key++, kind);
    const double whole = *std::max_element(std::begin(truth.value), std::end(truth.value));
    for (int i = 0; i < 8; ++i)
      if (truth.value[i] > 0.05 * whole)
        result.push_back(
            std::max(0.0, std::abs(mean.value[i] - truth.value[i]) - tolerance * truth.value[i]) /
            error.value[i]);
  }
  std::sort(result.rbegin(), result.rend());
  return result;
}

std::unique_ptr<Sampler> sampler_of(SamplerKind kind, const LoadedScene& scene,
                                    const ShadingPoint& point, int candidates = 16) {
  SamplerOptions options;
  options.candidates = candidates;
  auto sampler = make_sampler_factory(kind, scene, options)->make(16);
  sampler->prepare(point, scene.materials()[0]);
  return sampler;
}

} // namespace

TEST_CASE("resampled directions are unbiased however few, behind any visibility") {
  for (const SamplerKind kind : {SamplerKind::Ris, SamplerKind::BisSir})
    for (const char* material : {"rough", "glossy"})
      for (const Points points : {Points::Random, Points::Sobol}) {
        const std::vector<double> sigmas = deviations(kind, material, points);
        INFO(sampler_name(kind) << ", " << material << ": " << sigmas[0] << ' ' << sigmas[1] << ' '
                                << sigmas[2] << " of " << sigmas.size());
        CHECK(sigmas[0] < 5);
        CHECK(sigmas[2] < 3);
      }
}

TEST_CASE("rejection is off by little however few the samples, and by less with more") {
  for (const char* material : {"rough", "glossy"}) {
    const std::vector<double> sigmas =
        deviations(SamplerKind::BisReject, material, Points::Random, 0.02);
    INFO(material << ": " << sigmas[0] << ' ' << sigmas[1] << ' ' << sigmas[2]);
    CHECK(sigmas[0] < 5);
    CHECK(sigmas[2] < 3);
  }
  constexpr SamplerKind kinds[] = {SamplerKind::BisReject};
  check_unbiased(kinds, 1); // of 4096 samples at once
}

TEST_CASE("rejection draws from the product") {
  const SceneDescription description = fixture().scene("rough", "studio");
  const LoadedScene scene(description, {}, SamplerKind::BisReject, false);
  const ShadingPoint point = shading_points()[3];
  const double truth = quadrature(scene, point, probe_of(description));
  const auto sampler = sampler_of(SamplerKind::BisReject, scene, point, 1024);
  constexpr int per_round = 64; // of 65536 tries at most
  constexpr int count = 50000 / per_round * per_round;
  std::vector<DirectionSample> samples(count);
  for (std::uint32_t i = 0; i < count; i += per_round)
    sampler->sample({Points::Random, hash_words(7, i), 0},
                    std::span(samples).subspan(i, per_round));
  const auto result = chi_square(
      count, 32, 16,
      [&](int i) {
        return wavelet::sphere_to_square(samples[static_cast<std::size_t>(i)].direction);
      },
      [&](Vec2 p) {
        return integrand(scene, point, wavelet::square_to_sphere(p)) / truth *
               static_cast<double>(wavelet::sphere_area);
      });
  CHECK(result.pdf_sum == Approx(1).margin(0.02));
  CHECK(result.statistic < result.limit);
}

TEST_CASE("samples of bidirectional importance sampling have the same luminance") {
  const LoadedScene scene(fixture().scene("glossy", "spheres"), {}, SamplerKind::BisSir, false);
  const ShadingPoint point = shading_points()[1];
  const auto sampler = sampler_of(SamplerKind::BisSir, scene, point);
  std::vector<DirectionSample> samples(256);
  sampler->sample({Points::Sobol, 3, 0}, samples);
  const double first = integrand(scene, point, samples[0].direction) / samples[0].pdf;
  for (const DirectionSample& s : samples)
    CHECK(integrand(scene, point, s.direction) / s.pdf == Approx(first).epsilon(1e-4));
}

TEST_CASE("resampling samplers report the density of their candidates") {
  const LoadedScene scene(fixture().scene("rough", "studio"), {}, SamplerKind::Mis, false);
  for (const ShadingPoint& point : shading_points()) {
    const auto light = sampler_of(SamplerKind::Light, scene, point);
    const auto brdf = sampler_of(SamplerKind::Brdf, scene, point);
    const auto mis = sampler_of(SamplerKind::Mis, scene, point);
    const auto ris = sampler_of(SamplerKind::Ris, scene, point);
    const auto sir = sampler_of(SamplerKind::BisSir, scene, point);
    const Vec3 w = point.reflection.frame.n;
    CHECK(ris->pdf(w, 3) == mis->pdf(w, 2));
    CHECK((sir->pdf(w, 1) == light->pdf(w, 1) || sir->pdf(w, 1) == brdf->pdf(w, 1)));
  }
}

TEST_CASE("the power heuristic is unbiased and draws what the balance heuristic draws") {
  constexpr SamplerKind kinds[] = {SamplerKind::MisPower};
  check_unbiased(kinds, 1);
  check_densities(kinds);
}

TEST_CASE("the power heuristic weights as Veach has it") {
  const LoadedScene scene(fixture().scene("rough", "studio"), {}, SamplerKind::Mis, false);
  const ShadingPoint point = shading_points()[2];
  const auto balance = sampler_of(SamplerKind::Mis, scene, point);
  const auto power = sampler_of(SamplerKind::MisPower, scene, point);
  std::vector<DirectionSample> a(9); // five of the light, four of the reflectance
  std::vector<DirectionSample> b(9);
  balance->sample({Points::Sobol, 5, 0}, a);
  power->sample({Points::Sobol, 5, 0}, b);
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(a[i].direction == b[i].direction);
    const double light = 5.0 * static_cast<double>(scene.light().pdf(a[i].direction));
    const double lobe = 9.0 * static_cast<double>(a[i].pdf) - light;
    const double own = i < 5 ? light : lobe;
    const double weight = own * own / (light * light + lobe * lobe);
    CHECK(b[i].pdf == Approx(own / (9 * weight)).epsilon(1e-3));
  }
}
