#include "sampler_checks.h"

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr SamplerKind two_stage[] = {SamplerKind::TwoStage};

/// Relative variance of one sample, by quadrature.
double relative_variance(SamplerKind kind, const char* material, int regions) {
  const SceneDescription description = fixture().scene(material, "studio");
  const probe::Probe source = probe_of(description);
  const LoadedScene scene(description, {}, kind, false);
  SamplerOptions options;
  options.regions = regions;
  const auto sampler = make_sampler_factory(kind, scene, options)->make(16);
  double sum = 0;
  for (const ShadingPoint& point : shading_points()) {
    sampler->prepare(point, scene.materials()[0]);
    const double truth = quadrature(scene, point, source);
    const double error = true_error(scene, *sampler, point, source, truth);
    sum += error * error * sample_count / (truth * truth);
  }
  return sum / static_cast<double>(shading_points().size());
}

} // namespace

TEST_CASE("two-stage sampling with the unbiased estimator agrees with brute-force quadrature") {
  check_unbiased(two_stage, 1);
}

TEST_CASE("two-stage sampling draws what its pdf says") { check_densities(two_stage); }

TEST_CASE("two-stage sampling comes closer to the product with more regions") {
  for (const char* material : {"rough", "glossy"}) {
    const double coarse = relative_variance(SamplerKind::TwoStage, material, 4);
    const double medium = relative_variance(SamplerKind::TwoStage, material, 64);
    const double fine = relative_variance(SamplerKind::TwoStage, material, 1024);
    const double mis = relative_variance(SamplerKind::Mis, material, 4);
    INFO(material << ": " << coarse << ", " << medium << ", " << fine << "; mis " << mis);
    CHECK(medium < 0.7 * coarse);
    CHECK(fine < 0.7 * medium);
    CHECK(fine < 0.2 * mis);
  }
}

TEST_CASE("two-stage sampling counts each sample with its pdf") {
  const LoadedScene scene(fixture().scene("glossy", "studio"), {}, SamplerKind::TwoStage, false);
  const auto sampler = make_sampler_factory(SamplerKind::TwoStage, scene, {})->make(16);
  sampler->prepare(shading_points()[1], scene.materials()[0]);
  std::vector<DirectionSample> samples(10000);
  sampler->sample({Points::Random, 1, 0}, samples);
  int different = 0; // where rounding takes a direction over a pixel's edge
  for (const DirectionSample& s : samples)
    if (s.pdf > 0 && std::abs(sampler->pdf(s.direction, 1) / s.pdf - 1) > 1e-3F)
      ++different;
  CHECK(different < 20);
}

TEST_CASE("two-stage sampling draws from a light that is a tree alone") {
  SceneDescription description = fixture().scene("rough", "studio");
  description.light.probe.clear();
  const LoadedScene scene(description, {}, SamplerKind::TwoStage, false);
  const ShadingPoint point = shading_points()[0];
  const auto sampler = make_sampler_factory(SamplerKind::TwoStage, scene, {})->make(16);
  sampler->prepare(point, scene.materials()[0]);
  double truth = 0;
  constexpr int side = 512;
  for (int i = 0; i < side * side; ++i) {
    const Vec2 p((static_cast<float>(i % side) + 0.5F) / side,
                 (static_cast<float>(i / side) + 0.5F) / side);
    truth += integrand(scene, point, wavelet::square_to_sphere(p)) *
             static_cast<double>(wavelet::sphere_area) / (side * side);
  }
  CHECK(estimate_with(scene, *sampler, point, 1).mean == Approx(truth).epsilon(0.02));
}
