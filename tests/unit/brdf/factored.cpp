#include "brdf_test_support.h"
#include "chi_square.h"

#include <brdf/analytic.h>
#include <brdf/factored_brdf.h>
#include <wavelet/square/sphere_map.h>

using namespace haarlight;
using namespace haarlight::brdf;
using namespace brdf_test;

namespace {

Matrix random_matrix(std::size_t rows, std::size_t columns, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<float> uniform(0, 1);
  Matrix m(rows, columns);
  std::ranges::generate(m.values, [&] { return uniform(generator); });
  return m;
}

float product_at(const NonnegativeFactors& factors, std::size_t r, std::size_t c) {
  float sum = 0;
  for (std::size_t j = 0; j < factors.f.columns; ++j)
    sum += factors.f.row(r)[j] * factors.g.row(c)[j];
  return sum;
}

/// A ridge that moves with the row, as lobes do.
Matrix moving_ridge() {
  Matrix y(12, 30);
  for (std::size_t r = 0; r < y.rows; ++r)
    for (std::size_t c = 0; c < y.columns; ++c) {
      const float d = static_cast<float>(c) - 2 * static_cast<float>(r) - 3;
      y.row(r)[c] = std::exp(-0.05F * d * d);
    }
  return y;
}

double misfit(const Matrix& y, std::size_t terms) {
  const NonnegativeFactors factors = factorise(y, terms, 200);
  double sum = 0;
  double total = 0;
  for (std::size_t r = 0; r < y.rows; ++r)
    for (std::size_t c = 0; c < y.columns; ++c) {
      sum += static_cast<double>(std::abs(product_at(factors, r, c) - y.row(r)[c]));
      total += static_cast<double>(y.row(r)[c]);
    }
  return sum / total;
}

FactoredBrdf factors_of(const AnalyticBrdf& model) {
  return FactoredBrdf([&](const Vec3& wo, std::span<const Vec3> directions, std::span<float> out) {
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = luminance(evaluate(model, directions[i], wo)) * std::max(0.0F, directions[i].z());
  });
}

Vec3 view_at(float cosine) { return {std::sqrt(1 - cosine * cosine), 0, cosine}; }

std::vector<FactoredBrdf::Sample> draw(const FactoredBrdf& factors, const FactoredBrdf::View& view,
                                       int count) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  const auto below_one = [&] { return std::min(uniform(generator), 0x1.fffffep-1F); };
  std::vector<FactoredBrdf::Sample> samples;
  for (int i = 0; i < count; ++i) {
    const float u = below_one();
    samples.push_back(factors.sample(view, {u, below_one()}));
  }
  return samples;
}

} // namespace

TEST_CASE("a matrix of one term is factorised exactly", "[factored]") {
  const Matrix f = random_matrix(7, 1, 1);
  const Matrix g = random_matrix(9, 1, 2);
  Matrix y(7, 9);
  for (std::size_t r = 0; r < 7; ++r)
    for (std::size_t c = 0; c < 9; ++c)
      y.row(r)[c] = f.values[r] * g.values[c];
  const NonnegativeFactors factors = factorise(y, 1, 3);
  for (std::size_t r = 0; r < 7; ++r)
    for (std::size_t c = 0; c < 9; ++c)
      CHECK(product_at(factors, r, c) == Approx(y.row(r)[c]).epsilon(1e-5));
}

TEST_CASE("factors keep the sums of rows, are not negative, and more of them fit better",
          "[factored]") {
  const Matrix y = random_matrix(10, 20, 3);
  const NonnegativeFactors factors = factorise(y, 4, 50);
  for (std::size_t r = 0; r < y.rows; ++r) {
    float given = 0;
    float kept = 0;
    for (std::size_t c = 0; c < y.columns; ++c) {
      given += y.row(r)[c];
      kept += product_at(factors, r, c);
    }
    CHECK(kept == Approx(given).epsilon(1e-4));
  }
  CHECK(std::ranges::all_of(factors.f.values, [](float value) { return value >= 0; }));
  CHECK(std::ranges::all_of(factors.g.values, [](float value) { return value >= 0; }));
  const Matrix ridge = moving_ridge();
  CHECK(misfit(ridge, 2) < 0.8 * misfit(ridge, 1));
  CHECK(misfit(ridge, 6) < 0.2 * misfit(ridge, 1));
}

TEST_CASE("factored reflectances are sampled with the density stated", "[factored]") {
  const FactoredBrdf factors = factors_of(Ggx{Rgb(0.2F, 0.1F, 0.3F), Rgb::Constant(0.04F), 0.3});
  constexpr int count = 50000;
  for (const float cosine : {1.0F, 0.7F, 0.3F}) {
    const FactoredBrdf::View view = factors.view(view_at(cosine));
    const auto samples = draw(factors, view, count);
    const auto result = chi_square(
        count, 16, 24,
        [&](int i) {
          return wavelet::sphere_to_square(samples[static_cast<std::size_t>(i)].direction);
        },
        [&](Vec2 p) {
          return static_cast<double>(factors.pdf(view, wavelet::square_to_sphere(p)) *
                                     wavelet::sphere_area);
        });
    INFO("from cosine " << cosine);
    CHECK(result.pdf_sum == Approx(1).margin(0.01));
    CHECK(result.statistic < result.limit);
    for (std::size_t i = 0; i < samples.size(); i += 50)
      CHECK(factors.pdf(view, samples[i].direction) == Approx(samples[i].pdf).epsilon(2e-3));
  }
}

TEST_CASE("factors are the same each time", "[factored]") {
  const Ward ward{Rgb::Constant(0.1F), Rgb::Constant(0.5F), 0.2};
  const FactoredBrdf first = factors_of(ward);
  const FactoredBrdf second = factors_of(ward);
  const FactoredBrdf::View view = first.view(view_at(0.6F));
  CHECK(view.weights == second.view(view_at(0.6F)).weights);
  for (const auto& s : draw(first, view, 500))
    CHECK(second.pdf(view, s.direction) == first.pdf(view, s.direction));
}

TEST_CASE("factors of the measurements follow them", "[factored][shared-data]") {
  const TemporaryFolder folder;
  for (const char* name : {"violet-acrylic", "chrome"}) {
    const std::string path = unpack_measurement(name, folder);
    const MeasuredBrdf measured(path);
    const auto value = [&](const Vec3& wi, const Vec3& wo) {
      return luminance(measured.evaluate(wi, wo)) * std::max(0.0F, wi.z());
    };
    const FactoredBrdf factors(
        [&](const Vec3& wo, std::span<const Vec3> directions, std::span<float> out) {
          for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = value(directions[i], wo);
        });
    for (const float cosine : {0.98F, 0.8F, 0.5F, 0.2F}) {
      const FactoredBrdf::View view = factors.view(view_at(cosine));
      double sum = 0;
      double square = 0;
      for (const auto& s : draw(factors, view, 20000)) {
        const auto weight = static_cast<double>(value(s.direction, view.wo) / s.pdf);
        sum += weight / 20000;
        square += weight * weight / 20000;
      }
      INFO(name << " from cosine " << cosine);
      CHECK(square / (sum * sum) - 1 < 0.2);
    }
  }
}
