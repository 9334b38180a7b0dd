#include "sampler_checks.h"

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr SamplerKind unbiased_kinds[] = {SamplerKind::Pps};
constexpr SamplerKind all_kinds[] = {SamplerKind::Wais, SamplerKind::Pps};

void write_l2(const std::string& path, const wavelet::MapSource& source, double tolerance) {
  OutputFile file(path);
  wavelet::CompressOptions options;
  options.threshold.criterion = wavelet::Criterion::L2;
  options.threshold.tolerance = tolerance;
  wavelet::compress_set(source, options, file);
  file.commit();
}

/// A scene of the fixture with tables thresholded as published.
class L2Tables {
public:
  L2Tables(const std::string& material, const std::string& probe, double tolerance)
      : m_scene(fixture().scene(material, probe)) {
    brdf::BrdfMapOptions lobes;
    lobes.size = 32;
    lobes.theta = 16;
    lobes.roll = 16;
    m_scene.materials[0].table = m_folder.file("brdf.haar");
    write_l2(m_scene.materials[0].table,
             brdf::BrdfMaps(brdf::MeasuredBrdf(m_scene.materials[0].brdf), lobes), tolerance);
    probe::MapOptions maps;
    maps.size = 32;
    maps.orientations = 8;
    m_scene.light.table = m_folder.file("light.haar");
    write_l2(m_scene.light.table, probe::ProbeMaps(probe_of(m_scene), maps), tolerance);
  }

  const SceneDescription& scene() const { return m_scene; }

private:
  TemporaryFolder m_folder;
  SceneDescription m_scene;
};

/// ∫ f L cos dω over the directions that a sampler can draw, and over all.
struct Reach {
  double drawn = 0;
  double all = 0;
  double error = 0; ///< of the mean of sample_count samples
};

Reach reach_of(const LoadedScene& scene, const Sampler& sampler, const ShadingPoint& point,
               const probe::Probe& probe) {
  Reach reach;
  double square = 0;
  for_each_point(probe, 4, [&](const Vec3& w, double omega) {
    const double value = omega * integrand(scene, point, w);
    reach.all += value;
    if (const float pdf = sampler.pdf(w, sample_count); pdf > 0) {
      reach.drawn += value;
      square += value * value / (omega * static_cast<double>(pdf));
    }
  });
  reach.error = std::sqrt(std::max(0.0, square - reach.drawn * reach.drawn) / sample_count);
  return reach;
}

} // namespace

TEST_CASE("pps with the unbiased estimator agrees with brute-force quadrature") {
  check_unbiased(unbiased_kinds, 1);
}

TEST_CASE("wais and pps draw what their pdf says") { check_densities(all_kinds); }

TEST_CASE("pps is unbiased however few values it begins with") {
  const SceneDescription description = fixture().scene("glossy", "studio");
  const LoadedScene scene(description, {}, SamplerKind::Pps, false);
  const probe::Probe source = probe_of(description);
  for (const int values : {1, 3, 256}) {
    SamplerOptions options;
    options.pps_samples = values;
    const auto sampler = make_sampler_factory(SamplerKind::Pps, scene, options)->make(16);
    for (const ShadingPoint& point : shading_points()) {
      sampler->prepare(point, scene.materials()[0]);
      const double truth = quadrature(scene, point, source);
      const double error = true_error(scene, *sampler, point, source, truth);
      const double mean =
          estimate_with(scene, *sampler, point, static_cast<std::uint32_t>(values)).mean;
      INFO(values << " values: " << mean << " ± " << error << ", not " << truth);
      CHECK(std::abs(mean - truth) < 4.5 * error + 1e-3 * truth);
    }
  }
}

TEST_CASE("wais multiplies the same entries as product-table") {
  // The fixture's materials are grey, so that the product of luminances is the product's luminance.
  const SceneDescription description = fixture().scene("rough", "studio");
  const LoadedScene scene(description, {}, SamplerKind::ProductTable, false);
  const auto wais = make_sampler_factory(SamplerKind::Wais, scene, {})->make(16);
  const auto table = make_sampler_factory(SamplerKind::ProductTable, scene, {})->make(16);
  const probe::Probe source = probe_of(description);
  for (const ShadingPoint& point : shading_points()) {
    wais->prepare(point, scene.materials()[0]);
    table->prepare(point, scene.materials()[0]);
    double difference = 0; // ½ ∫ |p − q| dω
    for_each_point(source, 1, [&](const Vec3& w, double omega) {
      difference += 0.5 * omega * std::abs(static_cast<double>(wais->pdf(w, 1) - table->pdf(w, 1)));
    });
    // Apart from the floors that product-table adds.
    CHECK(difference < 0.03);
  }
}

TEST_CASE("wais loses what thresholding leaves without density, and nothing else") {
  const L2Tables tables("glossy", "studio", 0.2);
  const LoadedScene scene(tables.scene(), {}, SamplerKind::Wais, false);
  const auto sampler = make_sampler_factory(SamplerKind::Wais, scene, {})->make(16);
  const probe::Probe source = probe_of(tables.scene());
  double lost = 0;
  std::uint32_t key = 1;
  for (const ShadingPoint& point : shading_points()) {
    sampler->prepare(point, scene.materials()[0]);
    const Reach reach = reach_of(scene, *sampler, point, source);
    lost = std::max(lost, 1 - reach.drawn / reach.all);
    const Estimate estimate = estimate_with(scene, *sampler, point, key++);
    const double error = std::max(reach.error, estimate.error);
    INFO(estimate.mean << " ± " << error << ", not " << reach.drawn << " of " << reach.all);
    CHECK(std::abs(estimate.mean - reach.drawn) < 4.5 * error + 1e-3 * reach.drawn);
  }
  CHECK(lost > 1e-3);
  CHECK(traits(SamplerKind::Wais).bias == Bias::Biased);
}
