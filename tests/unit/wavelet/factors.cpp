#include "product_of.h"
#include "random_map.h"
#include "reference_basis.h"
#include "tree_views.h"

#include <wavelet/product/multiply.h>
#include <wavelet/product/projection.h>
#include <wavelet/product/synchronous_product.h>
#include <wavelet/square/sphere_map.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

Tree tree_of(const Map& map, double tolerance, bool grey = false) {
  CompressOptions options;
  options.threshold.criterion = Criterion::L2;
  options.threshold.tolerance = tolerance;
  options.coefficients = CoefficientType::Float;
  options.luminance = grey;
  CompressReport report;
  return compress_map(map, options, report);
}

/// Trees of unlike sparsity, size and number of channels.
std::vector<Tree> random_trees(std::size_t count, std::uint32_t seed) {
  std::vector<Tree> trees;
  for (std::size_t i = 0; i < count; ++i)
    trees.push_back(tree_of(random_map(i % 3 == 1 ? 16 : 32, seed + static_cast<std::uint32_t>(i)),
                            0.1 * static_cast<double>(i % 4), i % 3 == 2));
  return trees;
}

/// The plain way: multiply pixels.
std::vector<Eigen::Array3d> dense_product(const std::vector<TreeView>& trees, int level) {
  std::vector<Eigen::Array3d> result(std::size_t{1} << (2 * level), Eigen::Array3d::Ones());
  for (const TreeView& tree : trees) {
    const Map map = tree.reconstruct(level);
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] *= Eigen::Map<const Rgb>(map.rgb.data() + 3 * i).cast<double>();
  }
  return result;
}

Eigen::Array3d mean_of(const std::vector<Eigen::Array3d>& pixels) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const Eigen::Array3d& pixel : pixels)
    sum += pixel;
  return sum / static_cast<double>(pixels.size());
}

/// 1 inside a disc, on a grid of 32 × 32 pixels.
bool in_disc(int x, int y) { return std::hypot((x + 0.5) / 32 - 0.4, (y + 0.5) / 32 - 0.5) < 0.3; }

} // namespace

TEST_CASE("the product of n trees is the dense product, as integral, tree and inner product") {
  for (const std::size_t n : {1U, 2U, 3U, 5U}) {
    const std::vector<Tree> trees = random_trees(n, 100);
    const std::vector<TreeView> views = views_of(trees);
    const auto dense = dense_product(views, 5);
    const Eigen::Array3d expected = mean_of(dense);
    const double size = expected.abs().maxCoeff();
    const Rgb integral = product_integral(views);
    CHECK(((integral.cast<double>() - expected).abs() / size).maxCoeff() < 1e-5);

    const Tree product = multiply(views);
    const Map map = product.view().reconstruct(5);
    double worst = 0;
    double largest = 0;
    for (std::size_t i = 0; i < dense.size(); ++i) {
      const Rgb found = Eigen::Map<const Rgb>(map.rgb.data() + 3 * i);
      worst = std::max(worst, (found.cast<double>() - dense[i]).abs().maxCoeff());
      largest = std::max(largest, dense[i].abs().maxCoeff());
    }
    CHECK(worst < 1e-5 * largest);

    for (std::size_t split = 1; split < n; ++split) {
      const Tree first = multiply(std::span(views).first(split));
      const Tree second = multiply(std::span(views).subspan(split));
      const Rgb factored = inner_product(first.view(), second.view());
      CHECK(((factored.cast<double>() - expected).abs() / size).maxCoeff() < 1e-5);
    }
  }
}

TEST_CASE("the product as a tree has the reference's coefficients") {
  const std::vector<Tree> trees = random_trees(2, 7);
  const Tree product = multiply(views_of(trees));
  using namespace reference;
  for (const Channel channel : {Channel::Red, Channel::Green, Channel::Blue}) {
    const auto expected = reference::multiply(coefficient_set<double>(trees[0].view(), channel),
                                              coefficient_set<double>(trees[1].view(), channel));
    const auto found = coefficient_set<double>(product.view(), channel);
    CHECK(found.root == Approx(expected.root).epsilon(1e-5));
    double largest = 0;
    double worst = 0;
    for (const auto& entry : expected.details)
      for (int m = 1; m <= 3; ++m) {
        const double value = expected.at(entry.first, m);
        largest = std::max(largest, std::abs(value));
        worst = std::max(worst, std::abs(value - found.at(entry.first, m)));
      }
    CHECK(worst < 1e-5 * largest);
  }
}

TEST_CASE("products dropped as they are made stay within what was dropped") {
  const std::vector<Tree> trees = random_trees(3, 40);
  const std::vector<TreeView> views = views_of(trees);
  const Tree all = multiply(views);
  std::size_t before = all.links.size();
  for (const double tolerance : {0.01, 0.1}) {
    MultiplyOptions options;
    options.tolerance = tolerance;
    const Tree some = multiply(views, options);
    CHECK(some.links.size() < before);
    before = some.links.size();
    const Map a = all.view().reconstruct(5);
    const Map b = some.view().reconstruct(5);
    double square = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i)
      square += std::pow(static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]), 2) / 1024;
    const double dropped = 9.0 * static_cast<double>(all.links.size() - some.links.size());
    CHECK(std::sqrt(square) <=
          tolerance * static_cast<double>(luminance(all.mean)) * std::sqrt(dropped) * 1.001);
    CHECK((some.mean - all.mean).abs().maxCoeff() == 0);
  }
}

TEST_CASE("constants and functions with zeros are factors like any other") {
  std::vector<Tree> trees = random_trees(2, 60);
  Map disc(32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      disc.set(x, y, Rgb::Constant(in_disc(x, y) ? 1.0F : 0.0F));
  trees.push_back(tree_of(disc, 0));
  Tree constant;
  constant.mean = Rgb(0.5F, 2, 1);
  trees.push_back(constant);
  const std::vector<TreeView> views = views_of(trees);
  const TreeFactor factors[] = {TreeFactor(views[0]), TreeFactor(views[2]), TreeFactor(views[3]),
                                TreeFactor(views[1])};
  SynchronousProduct builder;
  const ProductTree& product = builder.build(factors);
  auto dense = dense_product({views[0], views[1]}, 5);
  for (std::size_t i = 0; i < dense.size(); ++i)
    dense[i] *= in_disc(static_cast<int>(i % 32), static_cast<int>(i / 32))
                    ? Eigen::Array3d(0.5, 2, 1)
                    : Eigen::Array3d(0, 0, 0);
  const Eigen::Array3d expected = mean_of(dense);
  CHECK(((product.integral().cast<double>() - expected).abs() / expected).maxCoeff() < 1e-5);

  const auto result = chi_square_of(product, 8);
  CHECK(result.pdf_sum == Approx(1).margin(1e-3));
  CHECK(result.statistic < result.limit);
}

TEST_CASE("the integral with a rotated reflectance is the dense sum over rotated directions") {
  Map lobe(64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const Vec3 w = square_to_sphere(
          Vec2((static_cast<float>(x) + 0.5F) / 64, (static_cast<float>(y) + 0.5F) / 64));
      lobe.set(x, y, Rgb(1.0F, 0.8F, 0.5F) * std::exp(6 * (w.z() - 1)));
    }
  const Tree lobe_tree = tree_of(lobe, 0);
  const TreeView lobes[2] = {lobe_tree.view(), lobe_tree.view()};
  const Pyramid pyramid(lobes);
  const Tree light = tree_of(random_map(64, 3), 0.1);
  const RotatedReflectance reflectance = {&pyramid, 0, 1, 0.5F,
                                          reflection_frame(Vec3::UnitX(), Vec3(0.8F, 0.6F, 0))};
  ProjectionOptions options;
  options.levels = 6;
  options.tolerance = 1e-3;
  const ProjectionFactor factors[] = {{light.view(), nullptr}};
  ProductProjector projector(options);
  projector.make(factors, &reflectance);
  const Map light_map = light.view().reconstruct(6);
  Eigen::Array3d expected = Eigen::Array3d::Zero();
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const Vec3 w = square_to_sphere(
          Vec2((static_cast<float>(x) + 0.5F) / 64, (static_cast<float>(y) + 0.5F) / 64));
      const Rgb value =
          Rgb(1.0F, 0.8F, 0.5F) * std::exp(6 * (reflectance.reflection.frame.n.dot(w) - 1));
      expected += (light_map.at(x, y) * value).cast<double>() / 4096;
    }
  const Rgb found = projector.mean();
  CHECK(((found.cast<double>() - expected).abs() / expected).maxCoeff() < 0.01);
}

TEST_CASE("trees give the averages of their quadrants, however they are turned or stored") {
  for (const float unit : {1.0F, 1e12F}) // halves of ordinary and of vast scale
    for (const CoefficientType type : {CoefficientType::Half, CoefficientType::Float}) {
      Map map = random_map(16, 90);
      for (float& value : map.rgb)
        value *= unit;
      CompressOptions options;
      options.coefficients = type;
      CompressReport report;
      const Tree tree = compress_map(map, options, report);
      const TreeView view = tree.view();
      const Float4 mean = to_lanes(view.mean);
      const std::uint32_t root = view.root();
      const std::int32_t slot = 0;
      for (int turns = 0; turns < 4; ++turns)
        for (const bool mirrored : {false, true}) {
          const SquareSymmetry symmetry = {turns, mirrored};
          Float4 means[4];
          std::uint32_t details[4];
          TreeFactor(view, symmetry).split({&slot, &mean, &root, 1}, {means, details});
          for (unsigned q = 0; q < 4; ++q) {
            const unsigned stored = symmetry.to_stored(q);
            const Rgb expected =
                view.average(1, static_cast<int>(stored & 1U), static_cast<int>(stored >> 1U));
            CHECK(((to_rgb(means[q]) - expected) / expected).abs().maxCoeff() < 1e-6F);
            CHECK(details[q] == view.child(root, stored));
          }
        }
    }
}

TEST_CASE("descents side by side are those one by one") {
  const std::vector<Tree> trees = random_trees(2, 80);
  const TreeFactor factors[2] = {TreeFactor(trees[0].view()), TreeFactor(trees[1].view())};
  SynchronousProduct builder;
  const ProductTree& product = builder.build(factors);
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (const std::size_t count : {1U, 31U, 64U, 200U}) {
    std::vector<Vec2> points(count);
    for (Vec2& p : points)
      p = Vec2(uniform(generator), uniform(generator));
    std::vector<Descent> together(count);
    product.sample(points, together);
    for (std::size_t i = 0; i < count; ++i) {
      const Descent alone = product.sample(points[i].x(), points[i].y());
      REQUIRE(end_point(together[i]) == end_point(alone));
      REQUIRE(together[i].pdf == alone.pdf);
    }
  }
}
