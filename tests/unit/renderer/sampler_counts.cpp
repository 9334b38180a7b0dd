// Samplers at small numbers of samples, and under a light of two pixels.

#include "crowded_scene.h"
#include "sampler_checks.h"

#include <renderer/film/render.h>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

/// The visible integral by runs of a few samples each.
struct Runs {
  double mean = 0;
  double variance = 0; ///< of one run's estimate
};

double estimate(const LoadedScene& scene, const ShadingPoint& point, Sampler& sampler,
                const PointSource& points, std::size_t count) {
  std::vector<DirectionSample> samples(count);
  sampler.sample(points, samples);
  std::vector<Vec3> directions;
  for (const DirectionSample& s : samples)
    directions.push_back(s.direction);
  std::vector<Rgb> radiance(count);
  sampler.radiance(scene.light(), directions, radiance);
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (samples[i].pdf > 0 && (point.hit == nullptr || visible(scene, *point.hit, directions[i])))
      sum += static_cast<double>(
          luminance(scene.materials()[0].evaluate(point, directions[i]) * radiance[i]) /
          samples[i].pdf);
  return sum / static_cast<double>(count);
}

Runs runs_of(const LoadedScene& scene, const ShadingPoint& point, Sampler& sampler,
             std::size_t count, std::size_t runs) {
  double sum = 0;
  double square = 0;
  for (std::uint32_t run = 0; run < runs; ++run) {
    const double x =
        estimate(scene, point, sampler, {Points::Random, hash_words(17, run), 0}, count);
    sum += x;
    square += x * x;
  }
  const auto n = static_cast<double>(runs);
  return {sum / n, (square - sum * sum / n) / (n - 1)};
}

struct ShadedPoint {
  Hit hit;
  ShadingPoint point;

  explicit ShadedPoint(const Vec3& n)
      : hit{1, n, n, 0}, point(shading_point(n, (n + 0.4F * frame_about(n).b).normalized())) {
    point.hit = &hit;
  }
};

double shaded_truth(const LoadedScene& scene, const ShadingPoint& point,
                    const probe::Probe& source) {
  double truth = 0;
  for_each_point(source, 4, [&](const Vec3& w, double omega) {
    truth += visible(scene, *point.hit, w) ? omega * integrand(scene, point, w) : 0;
  });
  return truth;
}

/// Whether runs of `count` samples draw the density that the sampler states for them.
void check_density_of_runs(const Sampler& density, Sampler& sampler, std::size_t count) {
  const std::size_t total = 12000 / count * count;
  std::vector<DirectionSample> samples(total);
  for (std::size_t i = 0; i < total; i += count)
    sampler.sample({Points::Random, hash_words(23, static_cast<std::uint32_t>(i)), 0},
                   std::span(samples).subspan(i, count));
  for (std::size_t i = 0; i < total; i += 97)
    CHECK(density.pdf(samples[i].direction, count) == Approx(samples[i].pdf).epsilon(1e-3));
  const auto result = chi_square(
      static_cast<int>(total), 16, 16,
      [&](int i) {
        return wavelet::sphere_to_square(samples[static_cast<std::size_t>(i)].direction);
      },
      [&](Vec2 p) {
        return static_cast<double>(density.pdf(wavelet::square_to_sphere(p), count) *
                                   wavelet::sphere_area);
      });
  CHECK(result.pdf_sum == Approx(1).margin(0.02));
  CHECK(result.statistic < result.limit);
}

constexpr SamplerKind mixtures[] = {SamplerKind::Mis, SamplerKind::MisPower, SamplerKind::Product,
                                    SamplerKind::ProductVisibility};

/// A light of two pixels, each half of the sphere.
class TwoPixels {
public:
  TwoPixels() {
    Image image(2, 1);
    image.set(0, 0, Rgb(1, 2, 3));
    image.set(1, 0, Rgb(20, 12, 16));
    probe::write_rgbe(file("two.hdr"), image);
    Image fine(64, 32); // the same light, for its trees
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x)
        fine.set(x, y, image.at(x / 32, 0));
    const probe::Probe source(fine, probe::Mapping::LatLong);
    probe::MapOptions options;
    options.size = 32;
    write_haar(file("two.haar"), probe::ProbeMaps(source, options));
    options.orientations = 8;
    write_haar(file("two-table.haar"), probe::ProbeMaps(source, options));
  }

  SceneDescription scene() const {
    SceneDescription scene = fixture().scene("rough", "studio");
    scene.light.probe = file("two.hdr");
    scene.light.mapping = "latlong";
    scene.light.haar = file("two.haar");
    scene.light.table = file("two-table.haar");
    return scene;
  }

private:
  std::string file(const char* name) const { return m_folder.file(name); }

  TemporaryFolder m_folder;
};

/// By the midpoints of equal squares.
double quadrature(const LoadedScene& scene, const ShadingPoint& point) {
  constexpr int side = 512;
  double sum = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      sum += integrand(scene, point,
                       wavelet::square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) / side,
                                                      (static_cast<float>(y) + 0.5F) / side)));
  return sum * static_cast<double>(wavelet::sphere_area) / (side * side);
}

/// Root mean square of the relative error over some keys.
double error_of(const LoadedScene& scene, const ShadingPoint& point, Sampler& sampler, Points kind,
                std::size_t count, double truth) {
  constexpr std::uint32_t keys = 6;
  double sum = 0;
  for (std::uint32_t key = 0; key < keys; ++key) {
    const double x = estimate(scene, point, sampler, {kind, hash_words(3, key), 0}, count);
    sum += (x / truth - 1) * (x / truth - 1) / keys;
  }
  return std::sqrt(sum);
}

} // namespace

TEST_CASE("mixtures draw the density they state, however few the samples") {
  for (const SamplerKind kind :
       {SamplerKind::Mis, SamplerKind::Product, SamplerKind::ProductVisibility}) {
    const LoadedScene scene(crowded("glossy"), {}, kind, false);
    const ShadedPoint shaded(Vec3(0.6F, 0.64F, 0.48F));
    const auto sampler = make_sampler_factory(kind, scene, {})->make(4);
    sampler->prepare(shaded.point, scene.materials()[0]);
    for (const std::size_t count : {1U, 2U, 3U, 4U, 5U}) {
      INFO(sampler_name(kind) << ", " << count << " samples");
      check_density_of_runs(*sampler, *sampler, count);
    }
  }
}

TEST_CASE("few samples are unbiased, and no less efficient each than many") {
  const Vec3 normals[] = {Vec3(0, 1, 0), Vec3(0.6F, 0.64F, 0.48F)};
  for (const char* material : {"rough", "glossy"})
    for (const SamplerKind kind : mixtures) {
      const LoadedScene scene(crowded(material), {}, kind, false);
      const auto sampler = make_sampler_factory(kind, scene, {})->make(4);
      for (const Vec3& n : normals) {
        const ShadedPoint shaded(n);
        sampler->prepare(shaded.point, scene.materials()[0]);
        const double truth = shaded_truth(scene, shaded.point, probe_of(crowded(material)));
        const double many = 64 * runs_of(scene, shaded.point, *sampler, 64, 64).variance;
        for (const std::size_t count : {1U, 2U, 3U, 4U, 5U}) {
          const std::size_t runs = 2048 / count;
          const Runs few = runs_of(scene, shaded.point, *sampler, count, runs);
          INFO(sampler_name(kind) << ", " << material << " at " << n.transpose() << ", " << count
                                  << " samples: " << few.mean << ", not " << truth
                                  << "; relative variance per sample "
                                  << static_cast<double>(count) * few.variance / (truth * truth)
                                  << ", of 64 " << many / (truth * truth));
          CHECK(std::abs(few.mean - truth) <
                4.5 * std::sqrt(few.variance / static_cast<double>(runs)) + 2e-3 * truth);
          // The split between techniques adds variance that many samples do not have.
          CHECK(static_cast<double>(count) * few.variance < 2 * many + 0.75 * truth * truth);
        }
      }
    }
}

TEST_CASE("every sampler converges under a light of two pixels, random or Sobol") {
  const TwoPixels light;
  const ShadingPoint point = shading_points()[3];
  for (const SamplerTraits& sampler_traits : samplers()) {
    const LoadedScene scene(light.scene(), {}, sampler_traits.kind, false);
    const double truth = quadrature(scene, point);
    const auto sampler = make_sampler_factory(sampler_traits.kind, scene, {})->make(64);
    sampler->prepare(point, scene.materials()[0]);
    for (const Points kind : {Points::Random, Points::Sobol}) {
      const double few = error_of(scene, point, *sampler, kind, 16, truth);
      const double many = error_of(scene, point, *sampler, kind, 1024, truth);
      INFO(sampler_traits.name << (kind == Points::Sobol ? ", Sobol" : ", random") << ": " << few
                               << " with 16 samples, " << many << " with 1024");
      // An eighth is what independent samples have; small errors are those of quadrature. wais has
      // a bias of its own.
      const double floor = sampler_traits.kind == SamplerKind::Wais ? 0.1 : 0.004;
      CHECK(many < std::max(0.25 * few, floor));
    }
  }
}

TEST_CASE("an unoccluded pixel is exactly the product's integral, whatever the directions") {
  SceneDescription description = fixture().scene("glossy", "spheres");
  description.camera.projection = CameraProjection::Orthographic;
  description.camera.from = Vec3(0, 1, 5);
  description.camera.height = 2.2;
  const LoadedScene scene(description, {}, SamplerKind::Product, true);
  RenderOptions options;
  options.estimator = Estimator::Ratio;
  options.spp = 64;
  options.sampling.product.variance_bound = 0.05F;
  const Film many = render(scene, options, 16, 16).film;
  options.estimator = Estimator::Bidirectional;
  for (const int spp : {1, 2, 5}) {
    options.spp = spp;
    options.seed = static_cast<std::uint32_t>(spp);
    const Film few = render(scene, options, 16, 16).film;
    float worst = 0;
    for (std::size_t i = 0; i < few.count(); ++i)
      worst = std::max(worst, (few.color(i) - many.color(i)).abs().maxCoeff() /
                                  std::max(1e-6F, many.color(i).maxCoeff()));
    CHECK(worst < 1e-4F);
  }
}

TEST_CASE("product-visibility resolves lobes at few samples as well") {
  const SceneDescription description = crowded("glossy");
  const LoadedScene scene(description, {}, SamplerKind::ProductVisibility, false);
  const auto sampler = make_sampler_factory(SamplerKind::ProductVisibility, scene, {})->make(1);
  const ShadedPoint shaded(Vec3(0.6F, 0.64F, 0.48F));
  sampler->prepare(shaded.point, scene.materials()[0]);
  CHECK(sampler->leaves() > 100);
}
