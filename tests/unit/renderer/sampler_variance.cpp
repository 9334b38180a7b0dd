// Whether the variance that a pixel reports of itself is the spread of its estimates over seeds.

#include "crowded_scene.h"
#include "film/pixel_sums.h"

#include <catch2/catch.hpp>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr std::uint32_t runs = 800;

struct Variances {
  double reported = 0; ///< mean over the runs
  double actual = 0;   ///< of the runs' estimates
};

/// A point of the crowded scene's sphere, with occluders.
struct ShadedPoint {
  Hit hit = {1, Vec3(0.6F, 0.64F, 0.48F), Vec3(0.6F, 0.64F, 0.48F), 0};
  ShadingPoint point =
      shading_point(hit.normal, (hit.normal + 0.4F * frame_about(hit.normal).b).normalized());

  ShadedPoint() { point.hit = &hit; }
};

/// One pixel's sums over `count` samples.
PixelSums sums_of(const LoadedScene& scene, Sampler& sampler, const ShadingPoint& point,
                  std::size_t count, std::uint32_t key) {
  std::vector<DirectionSample> samples(count);
  sampler.sample({Points::Random, key, 0}, samples);
  std::vector<Vec3> directions;
  for (const DirectionSample& s : samples)
    directions.push_back(s.direction);
  std::vector<Rgb> values(count);
  std::vector<Rgb> radiance(count);
  scene.materials()[0].evaluate(point, directions, values);
  sampler.radiance(scene.light(), directions, radiance);
  PixelSums sums;
  sums.product = Rgb::Ones();
  std::vector<std::uint8_t> seen(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Rgb weight =
        samples[i].pdf > 0 ? Rgb(values[i] * radiance[i] / samples[i].pdf) : Rgb(Rgb::Zero());
    seen[i] = (weight > 0).any() && visible(scene, *point.hit, directions[i]) ? 1 : 0;
    sums.add(weight, seen[i] != 0, samples[i].pdf, samples[i].technique);
  }
  sums.add_shared(sampler.shared_variance(seen));
  return sums;
}

Variances variances(const LoadedScene& scene, Sampler& sampler, const ShadingPoint& point,
                    std::size_t count, Estimator estimator) {
  Variances result;
  double sum = 0;
  double square = 0;
  for (std::uint32_t run = 0; run < runs; ++run) {
    const PixelSums sums = sums_of(scene, sampler, point, count, hash_words(11, run));
    const auto value = static_cast<double>(luminance(estimate(sums, estimator)));
    sum += value;
    square += value * value;
    result.reported += estimate_variance(sums, estimator) / runs;
  }
  result.actual = (square - sum * sum / runs) / (runs - 1);
  return result;
}

void check_variance(SamplerKind kind, const char* material, std::size_t count,
                    Estimator estimator) {
  const ShadedPoint shaded;
  const LoadedScene scene(crowded(material), {}, kind, false);
  const auto sampler = make_sampler_factory(kind, scene, {.count = count})->make(count);
  sampler->prepare(shaded.point, scene.materials()[0]);
  const Variances v = variances(scene, *sampler, shaded.point, count, estimator);
  INFO(sampler_name(kind) << ", " << material << ", " << count << " samples, "
                          << estimator_name(estimator) << ": " << v.reported << " reported, "
                          << v.actual);
  // 800 runs know a variance to 5 % if weights have a kurtosis of 3, and less well otherwise.
  CHECK(v.reported == Approx(v.actual).epsilon(0.2).margin(1e-12));
}

} // namespace

TEST_CASE("the reported variance is the variance over seeds, of every sampler") {
  for (const SamplerTraits& sampler : samplers())
    for (const std::size_t count : {8U, 13U})
      check_variance(sampler.kind, "rough", count, Estimator::Unbiased);
  for (const SamplerKind kind : {SamplerKind::Mis, SamplerKind::Product,
                                 SamplerKind::ProductVisibility, SamplerKind::BisSir})
    check_variance(kind, "glossy", 16, Estimator::Unbiased);
}

TEST_CASE("the ratio estimator reports its variance over seeds") {
  for (const SamplerKind kind :
       {SamplerKind::Mis, SamplerKind::Product, SamplerKind::BisSir, SamplerKind::BisReject})
    check_variance(kind, "rough", 64, Estimator::Ratio);
}

TEST_CASE("a technique of a single sample is taken as part of a mixture") {
  PixelSums sums;
  sums.add(Rgb::Constant(1), true, 1, Technique::First);
  sums.add(Rgb::Constant(3), true, 1, Technique::First);
  CHECK(estimate_variance(sums, Estimator::Unbiased) == Approx(1));
  sums.add(Rgb::Constant(5), true, 1, Technique::Second);
  CHECK(estimate_variance(sums, Estimator::Unbiased) == Approx(4.0 / 3));
  sums.add(Rgb::Constant(5), true, 1, Technique::Second);
  CHECK(estimate_variance(sums, Estimator::Unbiased) == Approx(4.0 / 16));
}
