#include "brdf_test_support.h"
#include "chi_square.h"

#include <brdf/analytic.h>
#include <wavelet/square/sphere_map.h>

using namespace haarlight;
using namespace haarlight::brdf;
using namespace brdf_test;

namespace {

struct Named {
  const char* name;
  AnalyticBrdf model;
};

/// Every model, with and without a diffuse part, wide and narrow.
std::vector<Named> models() {
  const Rgb half = Rgb::Constant(0.5F);
  const Rgb some = Rgb(0.3F, 0.1F, 0.2F);
  return {{"ggx", Ggx{Rgb::Zero(), half, 0.3}},
          {"rough ggx", Ggx{some, half, 1}},
          {"dielectric ggx", Ggx{some, Rgb::Constant(0.04F), 0.15}},
          {"blinn-phong", BlinnPhong{Rgb::Zero(), half, 60}},
          {"wide blinn-phong", BlinnPhong{some, half, 2}},
          {"ward", Ward{Rgb::Zero(), half, 0.25}},
          {"diffuse ward", Ward{some, half, 0.5}},
          {"lafortune", Lafortune{Rgb::Zero(), half, 40}},
          {"retro lafortune", Lafortune{some, half, 10, 0.8, 1}},
          {"sunken lafortune", Lafortune{some, half, 10, -1, -0.5}},
          {"ashikhmin-shirley", AshikhminShirley{Rgb::Zero(), half, 80}},
          {"diffuse ashikhmin-shirley", AshikhminShirley{some, half, 5}},
          {"no highlight", BlinnPhong{some, Rgb::Zero(), 5}}};
}

std::vector<Vec3> views() {
  std::vector<Vec3> result = {Vec3::UnitZ()};
  for (const float cosine : {0.8F, 0.4F, 0.1F}) {
    const float sine = std::sqrt(1 - cosine * cosine);
    result.emplace_back(0.6F * sine, -0.8F * sine, cosine);
  }
  return result;
}

std::vector<Vec3> draw(const AnalyticSampling& sampling, int count, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const float u = std::min(uniform(generator), 0x1.fffffep-1F);
    directions.push_back(sampling.sample({u, uniform(generator)}));
  }
  return directions;
}

/// ∫ f dω over the sphere by the midpoint rule on its square.
double integral(int n, const std::function<float(const Vec3&)>& f) {
  double sum = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto side = static_cast<float>(n);
      sum += static_cast<double>(f(wavelet::square_to_sphere(
          Vec2((static_cast<float>(x) + 0.5F) / side, (static_cast<float>(y) + 0.5F) / side))));
    }
  return sum * 4 * std::numbers::pi / (static_cast<double>(n) * n);
}

double albedo(const AnalyticBrdf& model, const Vec3& wo) {
  return integral(
      384, [&](const Vec3& wi) { return evaluate(model, wi, wo)[0] * std::max(0.0F, wi.z()); });
}

/// Chi-squared above the horizon. What falls below it counts together, in a corner of the square,
/// as half vectors across ω_o make the density rise without bound about −ω_o.
ChiSquareResult check_above(const AnalyticSampling& sampling, unsigned seed) {
  constexpr int count = 40000;
  constexpr int cells = 16;
  constexpr int taps = 20;
  const double above =
      integral(cells * taps, [&](const Vec3& wi) { return wi.z() > 0 ? sampling.pdf(wi) : 0.0F; });
  const std::vector<Vec3> directions = draw(sampling, count, seed);
  const auto draw_point = [&](int i) {
    const Vec3& wi = directions[static_cast<std::size_t>(i)];
    return wi.z() > 0 ? wavelet::sphere_to_square(wi) : Vec2(Vec2::Zero());
  };
  const auto density = [&](Vec2 p) {
    const Vec3 wi = wavelet::square_to_sphere(p);
    if (wi.z() > 0)
      return static_cast<double>(sampling.pdf(wi) * wavelet::sphere_area);
    return p.maxCoeff() < 1.0F / cells ? std::max(0.0, 1 - above) * cells * cells : 0.0;
  };
  return chi_square(count, cells, taps, draw_point, density);
}

} // namespace

TEST_CASE("analytic models are sampled with the density they state", "[analytic-sampling]") {
  unsigned seed = 1;
  for (const Named& named : models())
    for (const Vec3& wo : views()) {
      INFO(named.name << " from cosine " << wo.z());
      const auto result = check_above(AnalyticSampling(named.model, wo), seed++);
      CHECK(result.pdf_sum == Approx(1).margin(1e-3));
      CHECK(result.statistic < result.limit);
    }
}

TEST_CASE("densities of analytic models integrate to one", "[analytic-sampling]") {
  const Vec3 wo(0.6F, 0, 0.8F);
  for (const Named& named : models()) {
    const AnalyticSampling sampling(named.model, wo);
    INFO(named.name);
    CHECK(integral(384, [&](const Vec3& wi) { return sampling.pdf(wi); }) ==
          Approx(1).margin(0.01));
  }
}

TEST_CASE("sampled analytic models have the albedo of quadrature", "[analytic-sampling]") {
  constexpr int count = 40000;
  unsigned seed = 100;
  for (const Named& named : models())
    for (const Vec3& wo : views()) {
      const AnalyticSampling sampling(named.model, wo);
      double sum = 0;
      double square = 0;
      for (const Vec3& wi : draw(sampling, count, seed++)) {
        const float value = evaluate(named.model, wi, wo)[0] * std::max(0.0F, wi.z());
        const double weight = value > 0 ? static_cast<double>(value / sampling.pdf(wi)) : 0;
        sum += weight / count;
        square += weight * weight / count;
      }
      const double error = std::sqrt(std::max(0.0, square - sum * sum) / count);
      INFO(named.name << " from cosine " << wo.z());
      CHECK(std::abs(sum - albedo(named.model, wo)) < 4.5 * error + 2e-3 * sum);
    }
}

TEST_CASE("nothing that an analytic model reflects is out of reach", "[analytic-sampling]") {
  std::mt19937 generator(3);
  for (const Named& named : models())
    for (int i = 0; i < 2000; ++i) {
      const Vec3 wo = random_direction(generator);
      const Vec3 wi = random_direction(generator);
      const AnalyticSampling sampling(named.model, wo);
      INFO(named.name << " at " << wi.transpose() << " from " << wo.transpose());
      if ((evaluate(named.model, wi, wo) > 1e-30F).any()) // less is lost in the pdf's float
        REQUIRE(sampling.pdf(wi) > 0);
    }
}

TEST_CASE("narrow lobes are sampled without noise of their own", "[analytic-sampling]") {
  // Weights f cos / pdf of a narrow lobe vary little; rounding would make them jump.
  const AnalyticBrdf narrow[] = {
      Ggx{Rgb::Zero(), Rgb::Ones(), 1e-3}, BlinnPhong{Rgb::Zero(), Rgb::Ones(), 1e6},
      Ward{Rgb::Zero(), Rgb::Ones(), 1e-3}, Lafortune{Rgb::Zero(), Rgb::Ones(), 1e6},
      AshikhminShirley{Rgb::Zero(), Rgb::Ones(), 1e6}};
  const Vec3 wo(0.6F, 0, 0.8F);
  for (const AnalyticBrdf& model : narrow) {
    const AnalyticSampling sampling(model, wo);
    float lowest = 1e9F;
    float highest = 0;
    for (const Vec3& wi : draw(sampling, 2000, 9)) {
      CHECK(wi.norm() == Approx(1).epsilon(1e-6));
      const float weight = evaluate(model, wi, wo)[0] * wi.z() / sampling.pdf(wi);
      lowest = std::min(lowest, weight);
      highest = std::max(highest, weight);
    }
    INFO("model " << model.index());
    CHECK(lowest > 0.6F);
    CHECK(highest < 1.1F);
  }
}
