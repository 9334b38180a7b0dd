// Whether the variance that a pixel reports of itself is the spread of its estimates over seeds.

#include "crowded_scene.h"
#include "film/pixel_sums.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

/// A point of a sphere, with occluders or without.
struct ShadedPoint {
  Hit hit = {1, Vec3(0.6F, 0.64F, 0.48F), Vec3(0.6F, 0.64F, 0.48F), 0};
  ShadingPoint point =
      shading_point(hit.normal, (hit.normal + 0.4F * frame_about(hit.normal).b).normalized());

  explicit ShadedPoint(bool occluded) {
    if (occluded)
      point.hit = &hit;
  }
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
  std::vector<Contribution> contributions(count);
  for (std::size_t i = 0; i < count; ++i) {
    const DirectionSample& s = samples[i];
    const Rgb weight = s.pdf > 0 ? Rgb(values[i] * radiance[i] / s.pdf) : Rgb(Rgb::Zero());
    const bool reflects = (weight > 0).any();
    const bool v = reflects && (point.hit == nullptr || visible(scene, *point.hit, directions[i]));
    seen[i] = v ? 1 : 0;
    sums.add(weight, v, s.pdf);
    contributions[i] = {static_cast<double>(luminance(weight)), v, s.technique, s.first};
  }
  SumVariance variance = variance_of_sums(contributions);
  variance += sampler.shared_variance(seen);
  sums.add_variance(variance, static_cast<std::uint32_t>(count));
  return sums;
}

/// Of as many runs as it takes to know the difference of both variances to 3 %.
struct Comparison {
  double reported = 0; ///< mean over the runs
  double actual = 0;   ///< of the runs' estimates
  double error = 0;    ///< standard error of reported / actual
  std::size_t runs = 0;
};

Comparison compare(const std::vector<double>& values, const std::vector<double>& reported) {
  const auto n = static_cast<double>(values.size());
  Comparison result;
  result.runs = values.size();
  double mean = 0;
  for (const double value : values)
    mean += value / n;
  for (std::size_t i = 0; i < values.size(); ++i) {
    result.reported += reported[i] / n;
    result.actual += (values[i] - mean) * (values[i] - mean) / (n - 1);
  }
  double square = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double difference =
        (values[i] - mean) * (values[i] - mean) - result.actual - reported[i] + result.reported;
    square += difference * difference;
  }
  result.error = result.actual > 0 ? std::sqrt(square) / (n * result.actual) : 0;
  return result;
}

constexpr double enough = 0.03;

Comparison variances(const LoadedScene& scene, Sampler& sampler, const ShadingPoint& point,
                     std::size_t count, Estimator estimator) {
  constexpr std::size_t batch = 250;
  constexpr std::size_t most = 40000;
  std::vector<double> values;
  std::vector<double> reported;
  Comparison result;
  do {
    for (std::size_t i = 0; i < batch; ++i) {
      const PixelSums sums = sums_of(scene, sampler, point, count,
                                     hash_words(11, static_cast<std::uint32_t>(values.size())));
      values.push_back(static_cast<double>(luminance(estimate(sums, estimator))));
      reported.push_back(estimate_variance(sums, estimator));
    }
    result = compare(values, reported);
  } while (result.error > enough && values.size() < most);
  return result;
}

/// A sphere with two occluders that are cheap to test, loaded for one sampler.
class VarianceCheck {
public:
  VarianceCheck(SamplerKind kind, const char* material)
      : m_kind(kind), m_material(material), m_scene(scene(material), {}, kind, false) {}

  /// @param count of samples
  void check(bool occluded, std::size_t count, Estimator estimator = Estimator::Unbiased) const {
    const ShadedPoint shaded(occluded);
    const SamplerOptions options = {.count = count, .candidates = 4, .regions = 64};
    const auto sampler = make_sampler_factory(m_kind, m_scene, options)->make(count);
    sampler->prepare(shaded.point, m_scene.materials()[0]);
    const Comparison v = variances(m_scene, *sampler, shaded.point, count, estimator);
    INFO(sampler_name(m_kind) << ", " << m_material << (occluded ? ", occluded, " : ", open, ")
                              << count << " samples, " << estimator_name(estimator) << ": "
                              << v.reported << " reported, " << v.actual << " over " << v.runs
                              << " runs, ratio " << v.reported / v.actual << " +- " << v.error);
    CHECK(v.error <= enough);
    CHECK(v.reported == Approx(v.actual).epsilon(0.1).margin(1e-12));
  }

private:
  static SceneDescription scene(const char* material) {
    SceneDescription description = fixture().scene(material, "studio");
    const auto add = [&](const Shape& shape) { description.objects.push_back({shape, {}, 0}); };
    add(Plane{Vec3(1.6F, 0, 0), Vec3(-1, 0.3F, 0)});
    add(Sphere{Vec3(0.3F, 1.9F, 0.5F), 0.5F});
    return description;
  }

  SamplerKind m_kind;
  const char* m_material;
  LoadedScene m_scene;
};

/// Samplers of two techniques, and those whose samples share candidates.
constexpr SamplerKind special_kinds[] = {SamplerKind::Mis,     SamplerKind::MisPower,
                                         SamplerKind::Product, SamplerKind::ProductVisibility,
                                         SamplerKind::BisSir,  SamplerKind::BisReject};

} // namespace

TEST_CASE("the reported variance is the variance over seeds, of every sampler") {
  for (const SamplerTraits& sampler : samplers()) {
    const VarianceCheck variance(sampler.kind, "rough");
    for (const bool occluded : {false, true})
      variance.check(occluded, 4);
    variance.check(true, 16);
    if (std::ranges::find(special_kinds, sampler.kind) != std::end(special_kinds)) {
      variance.check(false, 16);
      variance.check(true, 64);
    }
  }
}

TEST_CASE("techniques of a single sample have an unbiased variance too") {
  for (const SamplerKind kind : {SamplerKind::Mis, SamplerKind::MisPower, SamplerKind::Product,
                                 SamplerKind::ProductVisibility})
    for (const std::size_t count : {2U, 3U, 7U})
      VarianceCheck(kind, "rough").check(true, count);
}

TEST_CASE("the ratio estimator reports its variance over seeds") {
  for (const SamplerKind kind :
       {SamplerKind::Mis, SamplerKind::Product, SamplerKind::BisSir, SamplerKind::BisReject})
    VarianceCheck(kind, "rough").check(true, 64, Estimator::Ratio);
}

TEST_CASE("a pair of samples of two techniques has the variance of a pair") {
  // Without overlap each sample is its technique's only one: nothing is known of its mean's square.
  const Contribution first = {3, true, Technique::First, {1, 1}};
  const Contribution second = {5, true, Technique::Second, {0, 0}};
  CHECK(variance_of_sums(std::array{first, second}).shadowed == Approx(9 + 25));
  // Of equal densities both are samples of one.
  const FirstWeights half = {0.5F, 0.5F};
  const Contribution a = {3, true, Technique::First, half};
  const Contribution b = {5, false, Technique::Second, half};
  const SumVariance v = variance_of_sums(std::array{a, b});
  CHECK(v.unshadowed == Approx(4));
  CHECK(v.shadowed == Approx(9));
  CHECK(v.covariance == Approx(9 - 15));
}

TEST_CASE("passes of one sample are taken to vary as the others") {
  PixelSums sums;
  for (const float w : {1.0F, 3.0F, 2.0F, 2.0F})
    sums.add(Rgb::Constant(w), true, 1);
  CHECK(estimate_variance(sums, Estimator::Unbiased) == 0);
  sums.add_variance({4, 4, 4}, 2);
  sums.add_variance({0, 0, 0}, 1);
  CHECK(estimate_variance(sums, Estimator::Unbiased) == Approx(8.0 / 16));
}
