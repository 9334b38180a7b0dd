#include <wavelet/base/elementary.h>
#include <wavelet/base/hash.h>
#include <wavelet/base/sampling.h>

#include <catch2/catch.hpp>

#include <limits>

using namespace haarlight;
using Catch::Detail::Approx;

TEST_CASE("elementary functions agree with the C library", "[elementary]") {
  for (double x = -7.9; x < 7.9; x += 0.0137) {
    REQUIRE(sine_cosine(x).sine == Approx(std::sin(x)).epsilon(0).margin(1e-14));
    REQUIRE(sine_cosine(x).cosine == Approx(std::cos(x)).epsilon(0).margin(1e-14));
    REQUIRE(exponential(80 * x) == Approx(std::exp(80 * x)).epsilon(1e-12).margin(1e-290));
    REQUIRE(logarithm(std::exp(x)) == Approx(std::log(std::exp(x))).epsilon(1e-13).margin(1e-15));
    REQUIRE(power(0.5 + 0.06 * x, 30) == Approx(std::pow(0.5 + 0.06 * x, 30)).epsilon(1e-12));
    REQUIRE(power(8 + x, -1.253) == Approx(std::pow(8 + x, -1.253)).epsilon(1e-13));
  }
  CHECK(exponential(-1000) == 0);
  CHECK(exponential(1e300) == exponential(709));
  CHECK(exponential(709) == Approx(std::exp(709)).epsilon(1e-12));
  CHECK(std::isnan(exponential(std::numeric_limits<double>::quiet_NaN())));
  CHECK(power(0, 3) == 0);
  CHECK(power(-1, 3) == 0);
}

TEST_CASE("sine and cosine of degrees", "[elementary]") {
  for (double degrees = -1000; degrees <= 1000; degrees += 0.37) {
    const SineCosine s = sine_cosine_degrees(degrees);
    REQUIRE(s.sine == Approx(std::sin(degrees * M_PI / 180)).margin(1e-14));
    REQUIRE(s.cosine == Approx(std::cos(degrees * M_PI / 180)).margin(1e-14));
  }
  CHECK(sine_cosine_degrees(90).cosine == 0);
  CHECK(sine_cosine_degrees(-90).sine == -1);
  CHECK(sine_cosine_degrees(540).cosine == -1);
  CHECK(sine_cosine_degrees(540).sine == 0);
}

TEST_CASE("cosine-weighted directions have their density", "[elementary]") {
  constexpr int n = 64;
  Vec3 sum = Vec3::Zero();
  float inverse_pdfs = 0; // ∫ dω over the hemisphere
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Vec2 u((static_cast<float>(i) + 0.5F) / n, (static_cast<float>(j) + 0.5F) / n);
      const Vec3 w = sample_cosine_hemisphere(u);
      REQUIRE(w.norm() == Approx(1).margin(1e-6));
      REQUIRE(sample_disk(u).norm() <= 1.000001F);
      sum += w / (n * n);
      inverse_pdfs += 1 / cosine_hemisphere_pdf(w) / (n * n);
    }
  CHECK((sum - Vec3(0, 0, 2.0F / 3)).norm() < 1e-3F);
  CHECK(inverse_pdfs == Approx(2 * pi).epsilon(0.1)); // the integrand diverges at the horizon
  CHECK(cosine_hemisphere_pdf(Vec3(0, 0.6F, -0.8F)) == 0);
}

TEST_CASE("hash functions give the published values", "[elementary]") {
  // First outputs of SplitMix64 seeded with 1234567.
  std::uint64_t state = 1234567;
  CHECK(splitmix64(state) == 6457827717110365317U);
  state += splitmix64_increment;
  CHECK(splitmix64(state) == 3203168211198807973U);
  CHECK(hash_bits(0) == 0);
  CHECK(hash_bits(1) == 1753845952U);
}
