// The figures that haarbench reports, on pixels whose truth and noise are known.
#include <bench/results.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>

using namespace haarlight::bench;

namespace {

/// Uniform noise of mean 0 and a given variance.
class Noise {
public:
  double operator()(double variance) {
    m_state = m_state * 6364136223846793005U + 1442695040888963407U;
    const double uniform = static_cast<double>(m_state >> 11U) * 0x1p-53;
    return std::sqrt(12 * variance) * (uniform - 0.5);
  }

private:
  std::uint64_t m_state = 1;
};

/// Bright and dark pixels.
double truth(std::size_t pixel) { return pixel % 2 == 0 ? 2.0 : 0.5; }

/// Runs whose pixels are `bias` times the truth with noise of a relative variance.
std::vector<Pixels> noisy_runs(std::size_t count, double relative_variance, Noise& noise,
                               double bias = 1) {
  std::vector<Pixels> runs(count, Pixels(4000));
  for (Pixels& run : runs)
    for (std::size_t i = 0; i < run.size(); ++i)
      run[i] = bias * truth(i) * (1 + noise(relative_variance));
  return runs;
}

} // namespace

TEST_CASE("relmse of pure noise is its relative variance", "[bench]") {
  Noise noise;
  const Reference exact = reference_of(noisy_runs(2, 0, noise));
  const Quality quality = quality_of(exact, noisy_runs(4, 0.04, noise));
  CHECK(quality.reference_relmse == 0);
  CHECK(quality.relmse == Approx(0.04).epsilon(0.03));
  CHECK(quality.relmse_stderr < 0.03 * 0.04);
  CHECK(quality.relmse_stderr > 0);
}

TEST_CASE("the reference's own noise is taken off", "[bench]") {
  Noise noise;
  const Reference reference = reference_of(noisy_runs(8, 0.008, noise));
  const Quality quality = quality_of(reference, noisy_runs(8, 0.001, noise));
  CHECK(quality.reference_relmse == Approx(0.001).epsilon(0.05));
  CHECK(quality.relmse == Approx(0.001).epsilon(0.1));
  CHECK(quality_of(reference, noisy_runs(2, 0, noise)).relmse < 0.0001);
}

TEST_CASE("bias shows in the mean ratio and in the error", "[bench]") {
  Noise noise;
  const Reference exact = reference_of(noisy_runs(2, 0, noise));
  const Quality biased = quality_of(exact, noisy_runs(2, 0, noise, 1.1));
  CHECK(biased.mean_ratio == Approx(1.1));
  CHECK(biased.mean_ratio_stderr == Approx(0).margin(1e-12));
  CHECK(biased.relmse == Approx(0.01).epsilon(0.001));
}

TEST_CASE("the mean ratio's standard error is that of the sums", "[bench]") {
  Noise noise;
  const double pixels = 4000;
  const double square_share = (4 + 0.25) / 2 / (1.25 * 1.25); // of the pixels' squares
  const Reference reference = reference_of(noisy_runs(8, 0.08, noise));
  const Quality quality = quality_of(reference, noisy_runs(4, 0.04, noise));
  const double expected = std::sqrt(square_share / pixels * (0.04 / 4 + 0.08 / 8));
  CHECK(quality.mean_ratio_stderr == Approx(expected).epsilon(0.05));
  CHECK(std::abs(quality.mean_ratio - 1) < 4 * quality.mean_ratio_stderr);
}

TEST_CASE("variances become relative ones, dark pixels by the floor", "[bench]") {
  const Reference reference = reference_of(std::vector<Pixels>{{2, 0}, {2, 0}});
  CHECK(reference.floor == Approx(1e-4));
  CHECK(relative_mean(reference, {4, 1e-4}) == Approx((4 / 4.0001 + 1) / 2));
}

TEST_CASE("nothing but black has neither error nor ratio", "[bench]") {
  const std::vector<Pixels> black = {{0, 0}, {0, 0}};
  const Quality quality = quality_of(reference_of(black), black);
  CHECK(quality.relmse == 0);
  CHECK(std::isnan(quality.mean_ratio));
}

TEST_CASE("the slope of errors that fall as a power is that power", "[bench]") {
  const std::vector<double> spp = {4, 16, 64, 256};
  std::vector<double> random;
  std::vector<double> smooth;
  for (const double n : spp) {
    random.push_back(3 / n);
    smooth.push_back(5 / std::pow(n, 1.5));
  }
  CHECK(log_slope(spp, random) == Approx(-1));
  CHECK(log_slope(spp, smooth) == Approx(-1.5));
  CHECK(log_slope(spp, std::vector<double>{0.75, 0, 0.046875, 0}) == Approx(-1));
  CHECK(std::isnan(log_slope(std::vector<double>{4}, std::vector<double>{1})));
}

TEST_CASE("a budget buys the samples that fit it", "[bench]") {
  CostModel cost;
  cost.add(256, 2 + 0.5 * 256);
  cost.add(16, 2 + 0.5 * 16);
  CHECK(cost.seconds_per_spp() == Approx(0.5));
  CHECK(cost.affordable(12, 1000) == 20);
  CHECK(cost.affordable(12.4, 1000) == 20);
  CHECK(cost.affordable(2 + 0.5 * 256, 1000) == 256);
  CHECK(cost.affordable(2 + 0.5 * 700, 1000) == 700);
  CHECK(cost.affordable(1e9, 1000) == 1000);
  CHECK(cost.affordable(0.1, 1000) == 1);
  cost.add(64, 2 + 0.5 * 64 + 10); // dearer in the middle than at its ends
  CHECK(cost.affordable(2 + 0.5 * 64 + 10, 1000) == 64);
}
