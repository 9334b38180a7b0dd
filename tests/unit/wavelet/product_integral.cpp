// Integrals of products of n functions, against pixels multiplied one by one.

#include "random_map.h"
#include "reference_basis.h"
#include "tree_views.h"

#include <wavelet/product/multiply.h>
#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// Trees of unlike sparsity and depth; every third is grey.
std::vector<Tree> random_trees(std::size_t count, int size, unsigned seed) {
  std::vector<Tree> trees;
  for (std::size_t i = 0; i < count; ++i) {
    CompressOptions options;
    options.threshold.criterion = Criterion::L2;
    options.threshold.tolerance = 0.1 * static_cast<double>(i % 4);
    options.coefficients = CoefficientType::Float;
    options.luminance = i % 3 == 2;
    CompressReport report;
    const int side = i % 3 == 1 ? size / 2 : size;
    trees.push_back(
        compress_map(random_map(side, seed + static_cast<unsigned>(i)), options, report));
  }
  return trees;
}

/// The integral, and that of the magnitude, which rounding errors are measured by.
struct Dense {
  Eigen::Array3d integral = Eigen::Array3d::Zero();
  double magnitude = 0;
};

Dense dense_integral(const std::vector<TreeView>& trees, int level) {
  const auto count = std::size_t{1} << (2U * static_cast<unsigned>(level));
  std::vector<Eigen::Array3d> pixels(count, Eigen::Array3d::Ones());
  for (const TreeView& tree : trees) {
    const Map map = tree.reconstruct(level);
    for (std::size_t i = 0; i < count; ++i)
      pixels[i] *= Eigen::Map<const Rgb>(map.rgb.data() + 3 * i).cast<double>();
  }
  Dense result;
  for (const Eigen::Array3d& pixel : pixels) {
    result.integral += pixel / static_cast<double>(count);
    result.magnitude += pixel.abs().maxCoeff() / static_cast<double>(count);
  }
  return result;
}

double error_of(const Rgb& found, const Dense& dense) {
  return (found.cast<double>() - dense.integral).abs().maxCoeff() / dense.magnitude;
}

/// Those of the trees whose bit is set.
std::vector<TreeView> chosen(const std::vector<TreeView>& trees, unsigned bits) {
  std::vector<TreeView> result;
  for (std::size_t i = 0; i < trees.size(); ++i)
    if ((bits >> i & 1U) != 0)
      result.push_back(trees[i]);
  return result;
}

} // namespace

TEST_CASE("integrals of 2 to 7 functions are those of the dense product", "[integral]") {
  for (const int size : {16, 64, 128})
    for (std::size_t n = 2; n <= 7; ++n) {
      CAPTURE(size, n);
      const std::vector<Tree> trees = random_trees(n, size, 50);
      const std::vector<TreeView> views = views_of(trees);
      const Dense dense = dense_integral(views, std::countr_zero(static_cast<unsigned>(size)));
      CHECK(dense.magnitude > 0);
      CHECK(error_of(product_integral(views), dense) < 1e-5);
    }
}

TEST_CASE("every way to split five factors in two gives their integral", "[integral]") {
  for (const int size : {16, 64, 128}) {
    const std::vector<Tree> trees = random_trees(5, size, 80);
    const std::vector<TreeView> views = views_of(trees);
    const Dense dense = dense_integral(views, std::countr_zero(static_cast<unsigned>(size)));
    for (unsigned bits = 1; bits < 31; ++bits) {
      CAPTURE(size, bits);
      const Tree first = multiply(chosen(views, bits));
      const Tree second = multiply(chosen(views, 31U & ~bits));
      CHECK(error_of(inner_product(first.view(), second.view()), dense) < 1e-5);
    }
  }
}

TEST_CASE("two functions: the walk, Parseval and sums of coefficients agree", "[integral]") {
  using namespace reference;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const std::vector<Tree> trees = random_trees(2, 32, seed);
    const std::vector<TreeView> views = views_of(trees);
    const Rgb walked = product_integral(views);
    const Rgb summed = inner_product(views[0], views[1]);
    for (const Channel channel : {Channel::Red, Channel::Green, Channel::Blue}) {
      const auto g = coefficient_set<double>(views[0], channel);
      const auto h = coefficient_set<double>(views[1], channel);
      const double expected = Product<double>(g, h).root();
      const auto lane = static_cast<int>(channel);
      CHECK(static_cast<double>(walked[lane]) == Approx(expected).epsilon(2e-6));
      CHECK(static_cast<double>(summed[lane]) == Approx(expected).epsilon(2e-6));
    }
  }
}
