#include "set_files.h"
#include "temporary_folder.h"

#include <wavelet/file/tree_set.h>
#include <wavelet/transform/threshold.h>
#include <wavelet/transform/transform.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

CompressOptions rounded(Criterion criterion, double tolerance) {
  CompressOptions options;
  options.threshold.criterion = criterion;
  options.threshold.tolerance = tolerance;
  options.quantize = true;
  return options;
}

/// ‖F − F'‖/‖F‖ by pixels, colours weighted by luminance.
double relative_error(const Map& map, const Map& kept) {
  double error = 0;
  double energy = 0;
  for (std::size_t i = 0; i < map.rgb.size(); ++i) {
    const double weight = std::array{0.2126, 0.7152, 0.0722}[i % 3];
    error += weight * std::pow(static_cast<double>(map.rgb[i] - kept.rgb[i]), 2);
    energy += weight * std::pow(static_cast<double>(map.rgb[i]), 2);
  }
  return std::sqrt(error / energy);
}

} // namespace

TEST_CASE("dropping and rounding together keep the l2 tolerance, and nearly reach it") {
  for (const double tolerance : {0.3, 0.03, 0.003, 0.0001})
    for (const unsigned seed : {1U, 2U, 3U}) {
      const Map map = random_map(64, seed);
      CompressReport report;
      CompressOptions options = rounded(Criterion::L2, tolerance);
      if (tolerance < 0.001) // finer than halves are
        options.coefficients = CoefficientType::Float;
      const Tree tree = compress_map(map, options, report);
      const double error = relative_error(map, tree.view().reconstruct(6));
      CHECK(error <= tolerance * 1.001);
      CHECK(error >= tolerance * 0.9);
      CHECK(report.relative_l2_error() == Approx(error).epsilon(1e-3));
    }
}

TEST_CASE("rounded coefficients are multiples of one step, and red and blue of two from green") {
  CompressReport report;
  const Tree tree = compress_map(random_map(32, 7), rounded(Criterion::L2, 0.05), report);
  std::size_t nonzero = 0;
  for (int level = 0; level < 5; ++level) {
    const float step = tree.scale * std::ldexp(1.0F, level - 4);
    const auto l = static_cast<std::size_t>(level);
    for (std::uint32_t n = tree.level_begin[l]; n < tree.level_begin[l + 1]; ++n) {
      const Details details = tree.view().details(n);
      for (const Float4 d : {details.d1, details.d2, details.d3}) {
        const float red = d[0] / step;
        const float green = d[1] / step;
        CHECK(green == std::nearbyint(green));
        CHECK(std::remainder(red - green, 2.0F) == 0);
        nonzero += to_rgb(d).isZero(0) ? 0 : 1;
      }
    }
  }
  CHECK(nonzero == report.kept_coefficients);
  CHECK(nonzero > 100);
}

TEST_CASE("the linf tolerance holds with rounding too") {
  const Map map = random_map(64, 5);
  for (const double tolerance : {0.3, 0.1, 0.03}) {
    CompressReport report;
    compress_map(map, rounded(Criterion::Linf, tolerance), report);
    CHECK(report.relative_linf_error() <= tolerance);
  }
}

TEST_CASE("rounding by the variance criterion moves no coefficient by more than may be dropped") {
  const double limit = 0.002;
  Map plain = random_map(64, 9);
  haar_forward(plain.rgb.data(), 64, 3);
  Map thresholded = plain;
  Map rounded_map = plain;
  const ThresholdOptions options = {Criterion::Variance, limit, std::nullopt};
  apply_threshold(thresholded, options);
  CHECK(apply_quantization(rounded_map, options).scale == 0);
  const double mean = luminance(plain.at(0, 0));
  std::size_t changed = 0;
  for (int level = 0; level < 6; ++level)
    for (int i = 0; i < (1 << 2 * level); ++i)
      for (int m = 1; m <= 3; ++m) {
        const std::size_t at =
            3 * coefficient_index(64, level, i & ((1 << level) - 1), i >> level, m);
        for (std::size_t c = 0; c < 3; ++c) {
          const float difference = std::abs(rounded_map.rgb[at + c] - thresholded.rgb[at + c]);
          changed += difference > 0 ? 1 : 0;
          // no average of this map is more than fifty times the mean
          CHECK(difference <= limit * std::sqrt(50.0) * mean * (1 << level));
        }
      }
  CHECK(changed > 1000);
}

TEST_CASE("at tolerance 0 rounding changes nothing") {
  const Map map = random_map(32, 4);
  CompressReport report;
  CompressOptions options = rounded(Criterion::L2, 0);
  const Tree tree = compress_map(map, options, report);
  options.quantize = false;
  CHECK(compress_map(map, options, report).coefficients == tree.coefficients);
}

TEST_CASE("rounding makes packed files much smaller") {
  const TemporaryFolder folder;
  for (const Criterion criterion : {Criterion::L2, Criterion::Variance}) {
    CompressOptions options = rounded(criterion, criterion == Criterion::L2 ? 0.02 : 0.005);
    options.packed = true;
    const auto small = write_set(folder.file("a.haar"), RandomSource(64, 2, 2), options);
    options.quantize = false;
    const auto large = write_set(folder.file("b.haar"), RandomSource(64, 2, 2), options);
    CHECK(5 * small.bytes < 3 * large.bytes);
  }
}
