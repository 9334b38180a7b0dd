#include "temporary_folder.h"

#include <wavelet/file/tree_set.h>
#include <wavelet/product/multiply.h>
#include <wavelet/product/projection.h>
#include <wavelet/transform/compress.h>
#include <wavelet/tree/pyramid.h>

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

constexpr int levels = 5;

/// Positive and rough everywhere, with a bright corner.
Map rough_map(unsigned seed) {
  std::mt19937 random(seed);
  Map map(1 << levels);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      const float base = x < 8 && y < 4 ? 20.0F : 1.0F;
      const auto noise = static_cast<float>(random() % 1000) / 1000.0F;
      map.set(x, y, base * (0.5F + noise) * Rgb(1, 0.8F, 0.3F));
    }
  return map;
}

Tree tree_of(const Map& map) {
  CompressOptions options;
  options.threshold.tolerance = 0;
  options.coefficients = CoefficientType::Float;
  CompressReport report;
  return compress_map(map, options, report);
}

/// 1 in a disk, with its coverage at its edge.
Map disk_map() {
  Map map(1 << levels);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      const float distance = std::hypot(static_cast<float>(x) - 12, static_cast<float>(y) - 17);
      map.set(x, y, Rgb::Constant(std::min(std::max(9.5F - distance, 0.0F), 1.0F)));
    }
  return map;
}

ProjectionOptions exact() {
  ProjectionOptions options;
  options.levels = levels;
  options.tolerance = 1e-4;
  options.coefficients = CoefficientType::Float;
  return options;
}

/// sqrt(∫ (T' − T)²/T' / ∫ T), squares darker than 3 % of the mean as if they were that bright.
double relative_error(const Map& truth, const Map& tree) {
  const auto mean = static_cast<double>(luminance(map_mean(truth).cast<float>()));
  double sum = 0;
  for (int y = 0; y < truth.size; ++y)
    for (int x = 0; x < truth.size; ++x) {
      const Rgb difference = tree.at(x, y) - truth.at(x, y);
      const double squares = static_cast<double>(luminance(difference * difference));
      sum += squares / std::max(static_cast<double>(luminance(tree.at(x, y))), 0.03 * mean);
    }
  return std::sqrt(sum / (mean * truth.size * truth.size));
}

} // namespace

TEST_CASE("a projection to no tolerance is the product of its trees") {
  const Tree a = tree_of(rough_map(1));
  const Tree b = tree_of(disk_map());
  const std::vector<float> variances = variances_within(a.view());
  const std::vector<ProjectionFactor> terms = {{a.view(), variances.data()}, {b.view(), nullptr}};
  ProductProjector projection(exact());
  const Tree product = projection.make(terms, nullptr);
  const TreeView views[2] = {a.view(), b.view()};
  CHECK((projection.mean() - product_integral(views)).abs().maxCoeff() < 1e-4F);
  const Map expected = multiply(views).view().reconstruct(levels);
  const Map made = product.view().reconstruct(levels);
  for (std::size_t i = 0; i < expected.rgb.size(); ++i)
    REQUIRE(made.rgb[i] == Approx(expected.rgb[i]).margin(2e-3));
}

TEST_CASE("a projection keeps its tolerance, its mean, and less the more it may drop") {
  const Tree a = tree_of(rough_map(2));
  const Tree b = tree_of(disk_map());
  const std::vector<float> variances = variances_within(a.view());
  const std::vector<ProjectionFactor> terms = {{a.view(), variances.data()}, {b.view(), nullptr}};
  const TreeView views[2] = {a.view(), b.view()};
  const Map expected = multiply(views).view().reconstruct(levels);
  std::size_t last = 1U << (2 * levels);
  for (const double tolerance : {0.02, 0.1, 0.4}) {
    ProjectionOptions options = exact();
    options.tolerance = tolerance;
    ProductProjector projection(options);
    const Tree tree = projection.make(terms, nullptr);
    INFO("tolerance " << tolerance);
    CHECK(tree.links.size() < last);
    last = tree.links.size();
    CHECK(relative_error(expected, tree.view().reconstruct(levels)) < 1.3 * tolerance);
    CHECK(relative_error(expected, tree.view().reconstruct(levels)) > 0.2 * tolerance);
    CHECK(projection.report().dropped <= tolerance * tolerance);
    CHECK((tree.mean - projection.mean()).abs().maxCoeff() == 0);
    CHECK((tree.mean - map_mean(expected).cast<float>()).abs().maxCoeff() < 0.02F);
  }
}

TEST_CASE("a projection of what is constant has no nodes, and black stays black") {
  const Tree grey = tree_of([] {
    Map map(4);
    std::fill(map.rgb.begin(), map.rgb.end(), 0.25F);
    return map;
  }());
  ProductProjector projection(exact());
  const std::vector<ProjectionFactor> terms = {{grey.view(), nullptr}};
  const Tree tree = projection.make(terms, nullptr);
  CHECK(tree.links.empty());
  CHECK((tree.mean == 0.25F).all());
  Tree black = grey;
  black.mean = Rgb::Zero();
  const std::vector<ProjectionFactor> none = {{grey.view(), nullptr}, {black.view(), nullptr}};
  CHECK((projection.make(none, nullptr).mean == 0).all());
}

TEST_CASE("projected trees obey the file format") {
  const TemporaryFolder folder;
  const Tree a = tree_of(rough_map(3));
  const std::vector<float> variances = variances_within(a.view());
  const std::vector<ProjectionFactor> terms = {{a.view(), variances.data()}};
  ProjectionOptions options;
  options.levels = levels;
  ProductProjector projection(options);
  SetInfo info;
  info.size = 1 << levels;
  OutputFile file(folder.file("t.haar"));
  TreeSetWriter writer(file, info, 3, options.coefficients);
  writer.add(projection.make(terms, nullptr));
  writer.finish();
  file.commit();
  CHECK_NOTHROW(TreeSet(folder.file("t.haar")));
}

TEST_CASE("variances within squares are those of their pixels") {
  const Map map = rough_map(4);
  const Tree tree = tree_of(map);
  const std::vector<float> variances = variances_within(tree.view());
  const auto mean = static_cast<double>(luminance(tree.mean));
  double sum = 0;
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x)
      sum += std::pow(static_cast<double>(luminance(map.at(x, y))) - mean, 2);
  CHECK(static_cast<double>(variances[0]) == Approx(sum / (map.size * map.size)).epsilon(1e-3));
}

TEST_CASE("averages and deviations scale with the function over the range of float") {
  const Map map = rough_map(6);
  const Tree tree = tree_of(map);
  const std::array trees = {tree.view()};
  const Pyramid pyramid(trees);
  for (const float scale : {0x1p-100F, 0x1p-66F, 0x1p66F, 0x1p100F}) {
    Map scaled = map;
    for (float& value : scaled.rgb)
      value *= scale;
    const Tree scaled_tree = tree_of(scaled);
    const std::array scaled_trees = {scaled_tree.view()};
    const Pyramid other(scaled_trees);
    for (const int level : {0, 2, 4}) {
      const Float4 expected = pyramid.lookup(0, level, 0.3F, 0.2F);
      const Float4 found = other.lookup(0, level, 0.3F, 0.2F) / scale;
      for (int c = 0; c < 4; ++c) {
        INFO(scale << " level " << level << " lane " << c);
        CHECK(float{found[c]} == Approx(float{expected[c]}).epsilon(0.01));
      }
    }
  }
}

TEST_CASE("dense coefficients give the inner products of trees") {
  const Map map = rough_map(5);
  const Tree dense = tree_of(map);
  const Tree disk = tree_of(disk_map());
  CompressOptions options;
  options.threshold.tolerance = 0.01;
  CompressReport report;
  const Tree sparse = compress_map(rough_map(6), options, report);
  const Tree constant = tree_of(Map(1));
  const TreeView trees[3] = {disk.view(), sparse.view(), constant.view()};
  Rgb out[3];
  DenseCoefficients(map).inner_products(trees, out);
  for (int i = 0; i < 3; ++i) {
    const Rgb expected = inner_product(trees[i], dense.view());
    CHECK((out[i] - expected).abs().maxCoeff() <= 1e-4F * expected.abs().maxCoeff());
  }
}
