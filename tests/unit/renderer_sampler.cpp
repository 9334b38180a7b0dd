#include "../../renderer/src/visibility/seen_squares.h"
#include "sampler_checks.h"

#include <wavelet/square_cap.h>

using namespace haarlight;
using namespace haarlight::renderer;

namespace {

constexpr SamplerKind basic_kinds[] = {SamplerKind::Product, SamplerKind::ProductTable,
                                       SamplerKind::Light, SamplerKind::Brdf, SamplerKind::Mis};

} // namespace

TEST_CASE("the basic samplers with the unbiased estimator agree with brute-force quadrature") {
  // Of 120 that stray by chance alone, 3 or fewer do with probability 0.9995.
  check_unbiased(basic_kinds, 3);
}

TEST_CASE("the basic samplers draw what their pdf says") { check_densities(basic_kinds); }

TEST_CASE("the product's own integral is close to the truth") {
  for (const char* material : {"rough", "glossy"}) {
    const SceneDescription description = fixture().scene(material, "studio");
    const LoadedScene scene(description, {}, SamplerKind::Product, false);
    const auto factory = make_sampler_factory(SamplerKind::Product, scene, {});
    const auto sampler = factory->make(16);
    const probe::Probe source = probe_of(description);
    double truth = 0;
    double product = 0;
    for (const ShadingPoint& point : shading_points()) {
      sampler->prepare(point, scene.materials()[0]);
      truth += quadrature(scene, point, source);
      product += static_cast<double>(luminance(*sampler->unshadowed()));
    }
    CHECK(product == Approx(truth).epsilon(0.03));
  }
}

TEST_CASE("a sampler whose table the scene does not name says which") {
  SceneDescription description = fixture().scene("rough", "studio");
  description.light.table.clear();
  CHECK_THROWS_WITH(LoadedScene(description, {}, SamplerKind::ProductTable, false),
                    Catch::Contains("\"table\""));
  description = fixture().scene("rough", "studio");
  std::swap(description.materials[0].haar, description.materials[0].table);
  CHECK_THROWS_WITH(LoadedScene(description, {}, SamplerKind::Product, false),
                    Catch::Contains("--roll 1"));
}

namespace {

/// Half of the directions above a point.
class HalfHidden : public wavelet::Occlusion {
public:
  explicit HalfHidden(const Vec3& side) : m_side(side) {}
  void find(std::span<const wavelet::SquarePlace> squares, std::span<float> seen) override {
    for (std::size_t i = 0; i < squares.size(); ++i)
      seen[i] = wavelet::positive_share_of(squares[i], [&](Float4 x, Float4 y, Float4 z) {
        return -(m_side.x() * x + m_side.y() * y + m_side.z() * z);
      });
  }

private:
  Vec3 m_side;
};

} // namespace

TEST_CASE("a product that thinks half of the light hidden is unbiased all the same") {
  const SceneDescription description = fixture().scene("glossy", "studio");
  const LoadedScene scene(description, {}, SamplerKind::Product, false);
  const auto factory = make_sampler_factory(SamplerKind::Product, scene, {});
  const auto sampler = factory->make(16);
  const probe::Probe source = probe_of(description);
  std::uint32_t key = 77;
  for (ShadingPoint point : shading_points()) {
    HalfHidden occlusion(frame_about(point.n).t);
    point.occlusion = &occlusion;
    sampler->prepare(point, scene.materials()[0]);
    const double truth = quadrature(scene, point, source);
    const auto [mean, own_error] = estimate_with(scene, *sampler, point, key++);
    const double error = std::max(own_error, true_error(scene, *sampler, point, source, truth));
    CHECK(std::abs(mean - truth) < 4.5 * error + 1e-3 * truth);
    std::vector<DirectionSample> samples(1000);
    sampler->sample({Points::Random, key++, 0}, samples);
    // A direction drawn next to a square's edge may be found on its other side.
    CHECK(std::ranges::count_if(samples, [&](const DirectionSample& s) {
            return sampler->pdf(s.direction, 1000) != Approx(s.pdf).epsilon(1e-3);
          }) <= 10);
  }
}

TEST_CASE("a product that knows what shapes hide agrees with brute force, and with its own pdf") {
  SceneDescription description = fixture().scene("rough", "studio");
  description.objects.push_back({Plane{Vec3(1.6F, 0, 0), Vec3(-1, 0.3F, 0)}, {}, 0});
  description.objects.push_back({Sphere{Vec3(0.3F, 1.9F, 0.5F), 0.5F}, {}, 0});
  description.objects.push_back({Box{Vec3(-1, 1.4F, 0.8F), Vec3(1, 1.6F, 1.4F)}, {}, 0});
  description.objects.push_back({Cylinder{Vec3(-0.6F, 0, -1), Vec3(-0.6F, 3, 0.5F), 0.1F}, {}, 0});
  description.objects.push_back({Torus{Vec3(0, 1.6F, 0), Vec3(0.2F, 1, 0.1F), 0.5F, 0.1F}, {}, 0});
  const LoadedScene scene(description, {}, SamplerKind::Product, false);
  const auto sampler = make_sampler_factory(SamplerKind::Product, scene, {})->make(16);
  const probe::Probe source = probe_of(description);
  detail::SeenSquares seen(scene.shapes(), scene.light());
  std::uint32_t key = 300;
  for (const Vec3& n : {Vec3(0, 1, 0), Vec3(0.6F, 0.64F, 0.48F), Vec3(0, 0.28F, 0.96F)}) {
    const Hit hit = {1, n, n, 0};
    seen.turn_to(hit);
    ShadingPoint point = shading_point(n, (n + 0.4F * frame_about(n).b).normalized());
    point.occlusion = &seen;
    sampler->prepare(point, scene.materials()[0]);
    const auto value = [&](const Vec3& w) {
      return scene.shapes().occluded(leave(hit, scene.light().to_world(w)))
                 ? 0.0
                 : integrand(scene, point, w);
    };
    double truth = 0;
    double square = 0;
    for_each_point(source, 4, [&](const Vec3& w, double omega) {
      if (const double f = value(w); f > 0) {
        truth += omega * f;
        square += omega * f * f / static_cast<double>(sampler->pdf(w, sample_count));
      }
    });
    std::vector<DirectionSample> samples(sample_count);
    sampler->sample({Points::Random, key++, 0}, samples);
    double mean = 0;
    for (const DirectionSample& s : samples)
      mean += value(s.direction) / static_cast<double>(s.pdf) / sample_count;
    CHECK(truth > 0);
    CHECK(std::abs(mean - truth) <
          4.5 * std::sqrt((square - truth * truth) / sample_count) + 2e-3 * truth);
    CHECK(square < 1.5 * truth * truth);
    const auto result = chi_square(
        static_cast<int>(sample_count), 16, 16,
        [&](int i) {
          return wavelet::sphere_to_square(samples[static_cast<std::size_t>(i)].direction);
        },
        [&](Vec2 p) {
          return static_cast<double>(sampler->pdf(wavelet::square_to_sphere(p), sample_count) *
                                     wavelet::sphere_area);
        });
    CHECK(result.pdf_sum == Approx(1).margin(0.02));
    CHECK(result.statistic < result.limit);
  }
}
