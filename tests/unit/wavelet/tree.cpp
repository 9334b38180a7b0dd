#include "random_map.h"

#include <wavelet/base/half.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

CompressOptions options(Criterion criterion, double tolerance, CoefficientType type) {
  CompressOptions result;
  result.threshold.criterion = criterion;
  result.threshold.tolerance = tolerance;
  result.coefficients = type;
  return result;
}

float largest_difference(const Map& a, const Map& b) {
  float worst = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i)
    worst = std::max(worst, std::abs(a.rgb[i] - b.rgb[i]));
  return worst;
}

Rgb plain_average(const Map& map, int level, int x, int y) {
  const int side = map.size >> level;
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      sum += map.at(x * side + i, y * side + j).cast<double>();
  return (sum / (static_cast<double>(side) * side)).cast<float>();
}

/// Every square of every level, and one level more, against the pixels of the reconstruction.
void require_dense_averages(const TreeView& tree) {
  const Map dense = tree.reconstruct(tree.levels);
  for (int level = 0; level <= tree.levels; ++level)
    for (int y = 0; y < (1 << level); ++y)
      for (int x = 0; x < (1 << level); ++x) {
        const Rgb difference = tree.average(level, x, y) - plain_average(dense, level, x, y);
        if (difference.abs().maxCoeff() > 5e-5F)
          FAIL("level " << level << " square " << x << ", " << y);
      }
  for (int y = 0; y < 2 * dense.size; ++y)
    for (int x = 0; x < 2 * dense.size; ++x) {
      const Rgb pixel = dense.at(x / 2, y / 2);
      const float step = 0.5F / static_cast<float>(dense.size);
      const float u = step * (static_cast<float>(x) + 0.5F);
      const float v = step * (static_cast<float>(y) + 0.5F);
      if ((tree.average(tree.levels + 1, x, y) != pixel).any() || (tree.value(u, v) != pixel).any())
        FAIL("point " << u << ", " << v);
    }
}

} // namespace

TEST_CASE("halves round to nearest even and come back exactly") {
  for (std::uint32_t h = 0; h < 0x10000; ++h) {
    const auto half = static_cast<std::uint16_t>(h);
    if (half_is_special(half))
      continue;
    const float value = half_to_float(half);
    CHECK_FALSE(std::isnan(value));
    if (float_to_half(value) != half)
      FAIL("half " << h << " does not survive");
  }
  CHECK(half_to_float(0x3c00) == 1.0F);
  CHECK(half_to_float(0x0001) == 0x1p-24F);
  CHECK(half_to_float(0xfbff) == -65504.0F);
  CHECK(float_to_half(1.0F + 0x1p-11F) == 0x3c00);     // a tie goes to the even neighbour
  CHECK(float_to_half(1.0F + 3 * 0x1p-11F) == 0x3c02); // and here to the other one
  CHECK(float_to_half(1.0F + 0x1p-11F + 0x1p-20F) == 0x3c01);
}

TEST_CASE("at tolerance 0 a tree gives the map back to rounding") {
  for (const int size : {1, 2, 32, 256}) {
    const Map map = random_map(size, 3);
    CompressReport report;
    const Tree exact = compress_map(map, options(Criterion::L2, 0, CoefficientType::Float), report);
    CHECK(report.relative_linf_error() < 5e-7);
    CHECK(largest_difference(exact.view().reconstruct(exact.levels), map) < 50 * 5e-7F);
    const Tree half = compress_map(map, options(Criterion::L2, 0, CoefficientType::Half), report);
    CHECK(report.relative_linf_error() < 1e-3);
    CHECK(half.links.size() == exact.links.size());
  }
}

TEST_CASE("averages over squares are those of the pixels, at every level") {
  const Map map = random_map(32, 11);
  CompressReport report;
  const Tree tree = compress_map(map, options(Criterion::L2, 0, CoefficientType::Float), report);
  for (int level = 0; level <= 5; ++level)
    for (int y = 0; y < (1 << level); ++y)
      for (int x = 0; x < (1 << level); ++x) {
        const Rgb difference = tree.view().average(level, x, y) - plain_average(map, level, x, y);
        if (difference.abs().maxCoeff() > 5e-5F)
          FAIL("level " << level << " square " << x << ", " << y);
      }
  CHECK((tree.view().value(0.51F, 0.99F) - map.at(16, 31)).abs().maxCoeff() < 5e-5F);
  CHECK((tree.view().value(1.0F, 0.0F) - map.at(31, 0)).abs().maxCoeff() < 5e-5F);
}

TEST_CASE("averages and values of sparse trees are those of the dense reconstruction") {
  struct Kind {
    CoefficientType type;
    bool luminance;
    bool sparse;
    double tolerance;
  };
  const std::vector<Kind> kinds = {{CoefficientType::Half, false, false, 0.3},
                                   {CoefficientType::Half, true, false, 0.1},
                                   {CoefficientType::Float, false, true, 0.05},
                                   {CoefficientType::Float, true, true, 0}};
  unsigned seed = 20;
  for (const Kind& kind : kinds) {
    CompressOptions sparse = options(Criterion::L2, kind.tolerance, kind.type);
    sparse.luminance = kind.luminance;
    CompressReport report;
    const Tree tree = compress_map(random_map(64, ++seed, kind.sparse), sparse, report);
    REQUIRE(tree.links.size() > 1);
    REQUIRE(report.kept_coefficients < report.total_coefficients);
    require_dense_averages(tree.view());
  }
}

TEST_CASE("l2 and linf tolerances bound the errors they name, and nearly reach the first") {
  const Map map = random_map(64, 5);
  CompressReport report;
  for (const double tolerance : {0.3, 0.1, 0.03}) {
    compress_map(map, options(Criterion::L2, tolerance, CoefficientType::Float), report);
    CHECK(report.relative_l2_error() <= tolerance * 1.0001);
    CHECK(report.relative_l2_error() >= tolerance * 0.97);
    compress_map(map, options(Criterion::Linf, tolerance, CoefficientType::Float), report);
    CHECK(report.relative_linf_error() <= tolerance);
    CHECK(report.kept_coefficients < report.total_coefficients);
  }
}

TEST_CASE("count keeps the coefficients that a plain ranking by magnitude keeps") {
  const Map map = random_map(32, 9);
  CompressOptions keep = options(Criterion::Count, 0, CoefficientType::Float);
  CompressReport previous;
  compress_map(map, options(Criterion::L2, 0, CoefficientType::Float), previous);
  double error = 10;
  for (const std::size_t count : {0, 1, 10, 100, 500, 1023}) {
    keep.threshold.keep = count;
    CompressReport report;
    compress_map(map, keep, report);
    CHECK(report.kept_coefficients == count);
    CHECK(report.relative_l2_error() <= error);
    error = report.relative_l2_error();
  }
  CHECK(error < 1e-6);
}

TEST_CASE("sparse maps make small trees, constant ones none") {
  CompressReport report;
  const Map sparse = random_map(64, 2, true);
  const Tree tree = compress_map(sparse, options(Criterion::L2, 0, CoefficientType::Half), report);
  CHECK(tree.links.size() < 64 * 6);
  Map constant(16);
  std::fill(constant.rgb.begin(), constant.rgb.end(), 2.0F);
  const Tree none = compress_map(constant, CompressOptions{}, report);
  CHECK(none.links.empty());
  CHECK(none.view().value(0.3F, 0.6F)[1] == 2.0F);
  CHECK(report.relative_l2_error() == 0);
}

TEST_CASE(
    "the variance criterion ranks a bump on a dim ground before the same bump on a bright one") {
  Map map(64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      map.set(x, y, Rgb::Constant(x < 32 ? 0.1F : 4.0F));
  map.set(8, 8, Rgb::Constant(1.1F));
  map.set(40, 8, Rgb::Constant(5.2F)); // a little higher: what a plain ranking prefers
  CompressReport report;
  CompressOptions keep = options(Criterion::Variance, 0, CoefficientType::Float);
  keep.threshold.keep = 4; // the step between the halves, and the finest square of one bump
  const Map by_variance = compress_map(map, keep, report).view().reconstruct(6);
  keep.threshold.criterion = Criterion::L2;
  const Map by_l2 = compress_map(map, keep, report).view().reconstruct(6);
  CHECK(by_variance.at(8, 8)[0] > 0.8F);
  CHECK(by_variance.at(40, 8)[0] < 4.2F);
  CHECK(by_l2.at(8, 8)[0] < 0.2F);
  CHECK(by_l2.at(40, 8)[0] > 4.8F);
}
