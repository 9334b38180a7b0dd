#include "brdf_test_support.h"

#include <brdf/analytic.h>
#include <brdf/brdf_properties.h>
#include <brdf/tabulate.h>

using namespace haarlight;
using namespace haarlight::brdf;
using namespace brdf_test;

namespace {

std::vector<AnalyticBrdf> all_models(const Rgb& diffuse) {
  Ggx ggx;
  BlinnPhong blinn;
  Ward ward;
  Lafortune lafortune;
  AshikhminShirley ashikhmin;
  ggx.diffuse = blinn.diffuse = ward.diffuse = lafortune.diffuse = ashikhmin.diffuse = diffuse;
  return {ggx, blinn, ward, lafortune, ashikhmin};
}

/// ∫ f_r cos dω over the hemisphere by the midpoint rule in (sin²θ, φ).
double albedo(const AnalyticBrdf& model, float cos_o) {
  constexpr int n = 300;
  const Vec3 wo(std::sqrt(1 - cos_o * cos_o), 0, cos_o);
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const float sine = std::sqrt((static_cast<float>(i) + 0.5F) / n);
    for (int j = 0; j < n; ++j) {
      const float phi = 2 * haarlight::pi * (static_cast<float>(j) + 0.5F) / n;
      const Vec3 wi(sine * std::cos(phi), sine * std::sin(phi), std::sqrt(1 - sine * sine));
      sum += static_cast<double>(evaluate(model, wi, wo)[1]);
    }
  }
  return sum * std::numbers::pi / (n * n);
}

} // namespace

TEST_CASE("analytic models are reciprocal, finite and not negative", "[analytic]") {
  std::mt19937 generator(1);
  for (const AnalyticBrdf& model : all_models(Rgb(0.1F, 0.2F, 0.3F))) {
    for (int i = 0; i < 2000; ++i) {
      const Vec3 wi = random_direction(generator);
      const Vec3 wo = random_direction(generator);
      const Rgb value = evaluate(model, wi, wo);
      const Rgb swapped = evaluate(model, wo, wi);
      REQUIRE((value >= 0).all());
      REQUIRE(value.isFinite().all());
      REQUIRE(value[0] == Approx(swapped[0]).epsilon(1e-5));
    }
    CHECK((evaluate(model, Vec3::UnitZ(), -Vec3::UnitZ()) == 0).all());
  }
}

TEST_CASE("analytic models reflect no more than arrives", "[analytic]") {
  for (AnalyticBrdf model : all_models(Rgb::Zero())) {
    std::visit([](auto& m) { m.specular = Rgb::Ones(); }, model);
    for (const float cos_o : {1.0F, 0.7F, 0.4F, 0.15F})
      CHECK(albedo(model, cos_o) < 1.01);
  }
}

TEST_CASE("specular colours are albedos where the models say so", "[analytic]") {
  Ggx white;
  white.specular = Rgb::Ones();
  white.roughness = 0.1;
  CHECK(albedo(white, 1) ==
        Approx(0.99).epsilon(0.01)); // single scattering loses little when smooth
  white.roughness = 1;
  CHECK(albedo(white, 1) < 0.8);
  CHECK(albedo(BlinnPhong(), 1) == Approx(0.5).epsilon(2e-3));
  CHECK(albedo(Lafortune(), 1) == Approx(0.5).epsilon(2e-3));
  CHECK(albedo(Ward(), 1) == Approx(0.5).epsilon(0.12));
  CHECK(albedo(Ward{Rgb::Constant(0.6F), Rgb::Zero()}, 1) == Approx(0.6).epsilon(1e-3));
  // Under a black F0 Schlick's term only shows at grazing angles.
  CHECK(albedo(Ggx{Rgb::Constant(0.6F), Rgb::Zero()}, 1) == Approx(0.6).epsilon(1e-2));
}

TEST_CASE("published values of the models", "[analytic]") {
  // At normal incidence and exitance every factor is known in closed form.
  const Vec3 z = Vec3::UnitZ();
  Ggx ggx;
  ggx.roughness = 0.3;
  CHECK(evaluate(ggx, z, z)[0] == Approx(0.04 / (4 * std::numbers::pi * 0.09)));
  Ward ward;
  CHECK(evaluate(ward, z, z)[0] == Approx(0.5 / (4 * std::numbers::pi * 0.04)));
  AshikhminShirley ashikhmin;
  CHECK(evaluate(ashikhmin, z, z)[0] == Approx(0.05 * 101 / (8 * std::numbers::pi)));
  Lafortune retro;
  retro.c_xy = 1;
  const Vec3 w = Vec3(0.6F, 0, 0.8F);
  CHECK(evaluate(retro, w, w)[0] == Approx(0.5 * 42 / (2 * std::numbers::pi)).epsilon(1e-4));
}

TEST_CASE("tabulated models read back as the model", "[tabulate]") {
  std::mt19937 generator(2);
  for (const AnalyticBrdf& model : all_models(Rgb::Constant(0.2F))) {
    const MeasuredBrdf brdf(tabulate(model));
    for (int i = 0; i < 3000; ++i) {
      const Vec3 wi = random_direction(generator);
      const Vec3 wo = random_direction(generator);
      if (std::min(wi.z(), wo.z()) < 0.1F)
        continue;
      const float expected = evaluate(model, wi, wo)[0];
      REQUIRE(brdf.evaluate(wi, wo)[0] == Approx(expected).epsilon(0.03).margin(0.004));
    }
    CHECK(bilateral_asymmetry(brdf) < 1e-9);
    // The horizon is not darkened: grazing values come from cells below it too.
    const Vec3 grazing = Vec3(1, 0, 0.012F).normalized();
    CHECK(brdf.evaluate(grazing, Vec3::UnitZ())[0] >
          0.9F * evaluate(model, grazing, Vec3::UnitZ())[0]);
  }
}

TEST_CASE("a tabulated Lambertian has its albedo from everywhere", "[tabulate]") {
  Ggx matt;
  matt.diffuse = Rgb(0.2F, 0.5F, 0.8F);
  matt.specular = Rgb::Zero();
  // Schlick's term still rises to one at grazing angles, so compare where it is small.
  const Rgb found =
      directional_albedo(MeasuredBrdf(constant_table(0.5 / std::numbers::pi)), 0.0, 1.5);
  CHECK(found[1] == Approx(0.5).epsilon(1e-3));
  const Rgb plain = directional_albedo(MeasuredBrdf(tabulate(matt)), 0.0, 0.3);
  CHECK(plain[2] / plain[0] == Approx(4).epsilon(0.01));
  const Rgb flat = directional_albedo(MeasuredBrdf(constant_table(0.5)), 0.3, 0.3, false);
  CHECK(flat[0] == Approx(std::numbers::pi).epsilon(2e-3));
}

TEST_CASE("noise is multiplicative, reproducible and never makes a cell invalid", "[tabulate]") {
  const AnalyticBrdf model = BlinnPhong{Rgb::Constant(0.4F), Rgb::Constant(0.3F), 50};
  const MerlTable clean = tabulate(model);
  const MerlTable noisy = tabulate(model, {0.05, 7});
  CHECK(noisy.raw == tabulate(model, {0.05, 7}).raw);
  CHECK(noisy.raw != tabulate(model, {0.05, 8}).raw);
  double sum = 0;
  double square = 0;
  double count = 0;
  int changed_validity = 0;
  for (std::size_t i = 0; i < clean.raw.size(); ++i) {
    changed_validity += (clean.raw[i] < 0) != (noisy.raw[i] < 0) ? 1 : 0;
    if (clean.raw[i] <= 0)
      continue;
    const double factor = noisy.raw[i] / clean.raw[i];
    sum += factor;
    square += factor * factor;
    ++count;
  }
  CHECK(changed_validity == 0);
  CHECK(sum / count == Approx(1).epsilon(1e-3));
  CHECK(std::sqrt(square / count - sum * sum / count / count) == Approx(0.05).epsilon(0.01));
}
