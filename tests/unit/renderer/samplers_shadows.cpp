// Samplers that know what is in the light's way.

#include "crowded_scene.h"
#include "sampler_checks.h"

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

/// First and second moment of the visible integrand over a sampler's density, by quadrature.
struct Moments {
  double mean = 0;
  double square = 0;
};

Moments moments(const LoadedScene& scene, const Sampler& sampler, const ShadingPoint& point,
                const probe::Probe& source) {
  Moments result;
  for_each_point(source, 4, [&](const Vec3& w, double omega) {
    const double f = visible(scene, *point.hit, w) ? integrand(scene, point, w) : 0;
    if (!(f > 0))
      return;
    result.mean += omega * f;
    result.square += omega * f * f / static_cast<double>(sampler.pdf(w, sample_count));
  });
  return result;
}

double estimate(const LoadedScene& scene, const ShadingPoint& point,
                std::span<const DirectionSample> samples) {
  double mean = 0;
  for (const DirectionSample& s : samples)
    if (s.pdf > 0 && visible(scene, *point.hit, s.direction))
      mean += integrand(scene, point, s.direction) / static_cast<double>(s.pdf);
  return mean / static_cast<double>(samples.size());
}

/// Whether a sampler is unbiased and draws what its pdf says at points that shapes throw shadows
/// on. @return the relative variance of its samples in the mean of the points
double check_in_shadow(SamplerKind kind, const std::string& material, std::uint32_t key) {
  const SceneDescription description = crowded(material);
  const LoadedScene scene(description, {}, kind, false);
  const auto sampler = make_sampler_factory(kind, scene, {})->make(16);
  const probe::Probe source = probe_of(description);
  double variance = 0;
  for (const Vec3& n : {Vec3(0, 1, 0), Vec3(0.6F, 0.64F, 0.48F), Vec3(0, 0.28F, 0.96F)}) {
    INFO(sampler_name(kind) << ", " << material << " at " << n.transpose());
    const Hit hit = {1, n, n, 0};
    ShadingPoint point = shading_point(n, (n + 0.4F * frame_about(n).b).normalized());
    point.hit = &hit;
    sampler->prepare(point, scene.materials()[0]);
    const Moments truth = moments(scene, *sampler, point, source);
    std::vector<DirectionSample> samples(sample_count);
    sampler->sample({Points::Random, key++, 0}, samples);
    const double relative = truth.square / (truth.mean * truth.mean) - 1;
    CHECK(std::abs(estimate(scene, point, samples) / truth.mean - 1) <
          4.5 * std::sqrt(relative / static_cast<double>(sample_count)) + 2e-3);
    const auto result = chi_square(
        static_cast<int>(sample_count), 32, 16,
        [&](int i) {
          return wavelet::sphere_to_square(samples[static_cast<std::size_t>(i)].direction);
        },
        [&](Vec2 p) {
          return static_cast<double>(sampler->pdf(wavelet::square_to_sphere(p), sample_count) *
                                     wavelet::sphere_area);
        });
    CHECK(result.pdf_sum == Approx(1).margin(0.02));
    CHECK(result.statistic < result.limit);
    variance += relative / 3;
  }
  return variance;
}

} // namespace

TEST_CASE("products with occluders agree with brute force and with their pdf") {
  std::uint32_t key = 300;
  for (const char* material : {"rough", "glossy"}) {
    const double by_rays = check_in_shadow(SamplerKind::Product, material, key);
    const double by_squares = check_in_shadow(SamplerKind::ProductVisibility, material, key + 10);
    INFO(material << ": relative variance " << by_squares << ", of product " << by_rays);
    CHECK(by_squares < 0.5 * by_rays);
    key += 20;
  }
}

TEST_CASE("product-visibility is as product where nothing may be in the way") {
  const SceneDescription description = fixture().scene("glossy", "studio");
  const LoadedScene scene(description, {}, SamplerKind::Product, false);
  const auto product = make_sampler_factory(SamplerKind::Product, scene, {})->make(16);
  const auto other = make_sampler_factory(SamplerKind::ProductVisibility, scene, {})->make(16);
  for (const ShadingPoint& point : shading_points()) {
    product->prepare(point, scene.materials()[0]);
    other->prepare(point, scene.materials()[0]);
    const Vec3 w = (point.n + 0.3F * frame_about(point.n).t).normalized();
    CHECK(product->pdf(w, 16) == other->pdf(w, 16));
  }
}
