// Coefficient sets, PSUM, CSUM, PRODUCT, OPPRODUCT and n-fold integrals against dense images.

#include "product_of.h"
#include "random_map.h"
#include "wavelet_reference_dense.h"

#include <wavelet/transform/compress.h>

#include <catch2/catch.hpp>

using namespace haarlight;
using namespace haarlight::wavelet;
using namespace haarlight::wavelet::reference;
using namespace reference_test;

namespace {

/// Allowed error relative to the largest value.
template <class T>
constexpr double tolerance = sizeof(T) == sizeof(float) ? 1e-5 : 1e-12;

constexpr Channel channels[4] = {Channel::Red, Channel::Green, Channel::Blue, Channel::Luminance};

template <class T>
Image dense(const CoefficientSet<T>& function, int levels) {
  return in_double(image_of(function, levels));
}

/// Largest difference of two functions' coefficients, stored or not.
template <class T>
double coefficient_difference(const CoefficientSet<T>& a, const CoefficientSet<double>& b) {
  double result = std::abs(static_cast<double>(a.root) - b.root);
  for_each_square(std::max(a.levels, b.levels), [&](const Square& s) {
    for (int m = 1; m <= 3; ++m)
      result = std::max(result, std::abs(static_cast<double>(a.at(s, m)) - b.at(s, m)));
  });
  return result;
}

/// Whether G·H by PRODUCT is the dense product, as coefficients and as an image.
template <class T>
void check_product(const CoefficientSet<T>& g, const CoefficientSet<T>& h) {
  const int levels = std::max(g.levels, h.levels);
  const Image expected = times(dense(g, levels), dense(h, levels));
  const CoefficientSet<T> found = multiply(g, h);
  const double limit = tolerance<T> * largest(expected);
  CHECK(found.levels == levels);
  CHECK(coefficient_difference(found, set_of<double>(expected)) < limit);
  CHECK(largest_difference(dense(found, levels), expected) < limit);
}

Tree tree_of(const Map& map, double l2_tolerance, CoefficientType type, bool grey = false) {
  CompressOptions options;
  options.threshold.criterion = Criterion::L2;
  options.threshold.tolerance = l2_tolerance;
  options.coefficients = type;
  options.luminance = grey;
  CompressReport report;
  return compress_map(map, options, report);
}

/// A broad lobe and a narrow one over a ground, nowhere near the table product's floor.
Map lobes(int size) {
  Map map(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(size) - 0.6F;
      const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(size) - 0.4F;
      const float r2 = u * u + v * v;
      const float lobe = 20 * std::exp(-900 * r2) + 2 * std::exp(-20 * r2) + 0.3F;
      map.set(x, y, Rgb(1.0F, 0.8F, 0.5F) * lobe);
    }
  return map;
}

Image channel_image(const Map& map, Channel channel) {
  Image image;
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      const Rgb c = map.at(x, y);
      image.push_back(static_cast<double>(
          channel == Channel::Luminance ? luminance(c) : c[static_cast<int>(channel)]));
    }
  return image;
}

/// A tree's scalars, in double.
struct Scalars {
  CoefficientSet<double> of[4];
  explicit Scalars(const Tree& tree) {
    for (const Channel channel : channels)
      of[static_cast<int>(channel)] = coefficient_set<double>(tree.view(), channel);
  }
};

} // namespace

TEMPLATE_TEST_CASE("reference: coefficients are inner products with the basis", "", float, double) {
  const Image image = random_image(16, 1);
  const auto set = set_of<TestType>(image);
  const Basis basis(16);
  for (std::size_t i = 0; i < basis.functions.size(); ++i) {
    const auto& [s, m] = basis.functions[i];
    const auto found = static_cast<double>(m > 0 ? set.at(s, m) : set.root);
    CHECK(std::abs(found - integral_of(image, basis.images[i])) <
          tolerance<TestType> * largest(image));
  }
}

TEMPLATE_TEST_CASE("reference: an image comes back from its coefficients, at any level", "", float,
                   double) {
  for (int levels = 0; levels <= 5; ++levels) {
    const Image image = random_image(1 << levels, static_cast<unsigned>(levels));
    const auto set = set_of<TestType>(image);
    CHECK(set.levels == levels);
    for (int level = 0; level <= levels + 1; ++level) {
      Image expected;
      for (unsigned y = 0; y < (1U << level); ++y)
        for (unsigned x = 0; x < (1U << level); ++x) {
          const Square s = {level, x, y};
          expected.push_back(average_of(image, s.ancestor(std::min(level, levels))));
        }
      CHECK(largest_difference(dense(set, level), expected) < tolerance<TestType> * largest(image));
    }
  }
}

TEST_CASE("reference: a constant image has no wavelets") {
  const auto set = set_of<double>(Image(64, 3.5));
  CHECK(set.root == 3.5);
  CHECK(set.details.empty());
  CHECK(set.at({2, 1, 1}, 3) == 0);
}

TEST_CASE("reference: a tree's channels and luminance are those of its image") {
  const Map map = random_map(32, 3);
  for (const CoefficientType type : {CoefficientType::Half, CoefficientType::Float})
    for (const bool grey : {false, true}) {
      const Tree tree = tree_of(map, 0.1, type, grey);
      const Map image = tree.view().reconstruct(5);
      for (const Channel channel : channels) {
        const Image expected = channel_image(image, channel);
        const auto set = coefficient_set<double>(tree.view(), channel);
        CHECK(set.details.size() <= tree.links.size());
        CHECK(coefficient_difference(coefficient_set<float>(tree.view(), channel), set) <
              1e-6 * set.root);
        CHECK(largest_difference(dense(set, 5), expected) < 1e-6 * largest(expected));
      }
    }
}

TEMPLATE_TEST_CASE("reference: PRODUCT is the dense product, at every size", "", float, double) {
  for (int levels = 0; levels <= 6; ++levels)
    for (unsigned seed = 0; seed < 3; ++seed) {
      CAPTURE(levels, seed);
      check_product(set_of<TestType>(random_image(1 << levels, 10 + seed)),
                    set_of<TestType>(random_image(1 << levels, 20 + seed)));
    }
}

TEMPLATE_TEST_CASE("reference: PRODUCT of sparse functions, of unlike size too", "", float,
                   double) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    CAPTURE(seed);
    check_product(sparse_set<TestType>(5, 40, seed), sparse_set<TestType>(5, 60, 100 + seed));
    check_product(sparse_set<TestType>(3, 10, seed), sparse_set<TestType>(6, 80, 200 + seed));
    check_product(sparse_set<TestType>(6, 80, seed), sparse_set<TestType>(1, 2, 300 + seed));
  }
}

TEMPLATE_TEST_CASE("reference: PRODUCT of each wavelet type with each", "", float, double) {
  for (int g_type = 1; g_type <= 3; ++g_type)
    for (int h_type = 1; h_type <= 3; ++h_type) {
      CAPTURE(g_type, h_type);
      check_product(sparse_set<TestType>(4, 50, 1, g_type), sparse_set<TestType>(4, 50, 2, h_type));
      CoefficientSet<TestType> g;
      CoefficientSet<TestType> h;
      g.levels = h.levels = 3;
      g.details[{2, 1, 3}][static_cast<std::size_t>(g_type - 1)] = 1;
      h.details[{2, 1, 3}][static_cast<std::size_t>(h_type - 1)] = 1;
      check_product(g, h);
      CHECK(multiply(g, h).details.size() == (g_type == h_type ? 2 : 1));
    }
}

TEST_CASE("reference: PRODUCT has the coefficients of the theorem, one by one") {
  const auto g = sparse_set<double>(3, 12, 1);
  const auto h = sparse_set<double>(3, 12, 2);
  Product<double> product(g, h);
  for (const BasisFunction& f : Basis(8).functions) {
    CoefficientSet<double> alone; // f itself
    if (f.m > 0)
      alone.details[f.square][static_cast<std::size_t>(f.m - 1)] = 1;
    else
      alone.root = 1;
    const CoefficientSet<double> three[3] = {alone, g, h};
    const double found = f.m > 0 ? product.coefficient(f.square, f.m) : product.root();
    CHECK(found == Approx(integral_by_theorem<double>(three)).margin(1e-12));
  }
}

TEMPLATE_TEST_CASE("reference: PSUM, CSUM and OPPRODUCT are dense averages at every square", "",
                   float, double) {
  const int levels = GENERATE(0, 1, 3, 5, 6);
  const bool sparse = GENERATE(false, true);
  if (sparse && levels == 0)
    return;
  const auto g =
      sparse ? sparse_set<TestType>(levels, 70, 1) : set_of<TestType>(random_image(1 << levels, 1));
  const auto h =
      sparse ? sparse_set<TestType>(levels, 70, 2) : set_of<TestType>(random_image(1 << levels, 2));
  const Image g_image = dense(g, levels);
  const Image h_image = dense(h, levels);
  const Image gh_image = times(g_image, h_image);
  ParentSums<TestType> g_of(g);
  Product<TestType> product(g, h);
  const ChildrenSums<TestType> csum(g, h);
  double psum_error = 0;
  double csum_error = 0;
  double average_error = 0;
  for_each_square(levels, [&](const Square& s) {
    const double g_mean = average_of(g_image, s);
    const double gh_mean = average_of(gh_image, s);
    const double covariance = gh_mean - g_mean * average_of(h_image, s);
    psum_error = std::max(psum_error, std::abs(static_cast<double>(g_of(s)) - g_mean));
    csum_error = std::max(
        csum_error, std::abs(std::ldexp(static_cast<double>(csum(s)), 2 * s.level) - covariance));
    average_error =
        std::max(average_error, std::abs(static_cast<double>(product.average(s)) - gh_mean));
  });
  CHECK(psum_error < tolerance<TestType> * largest(g_image));
  CHECK(csum_error < tolerance<TestType> * largest(gh_image));
  CHECK(average_error < tolerance<TestType> * largest(gh_image));
  CHECK(product.root() == product.average({}));
}

TEST_CASE("reference: below the finest wavelets functions are constant") {
  const auto g = sparse_set<double>(3, 20, 1);
  const auto h = sparse_set<double>(3, 20, 2);
  ParentSums<double> g_of(g);
  Product<double> product(g, h);
  for (unsigned i = 0; i < 64; ++i) {
    const Square pixel = {3, i % 8, i / 8};
    const Square inside = {7, 16 * pixel.column + 5, 16 * pixel.row + 11};
    CHECK(g_of(inside) == g_of(pixel));
    CHECK(product.average(inside) == product.average(pixel));
    CHECK(product.coefficient(inside, 2) == 0);
  }
}

TEMPLATE_TEST_CASE("reference: integrals agree pairwise, chained and factored at every split", "",
                   float, double) {
  const std::size_t count = GENERATE(2, 3, 4, 5, 7);
  std::vector<CoefficientSet<TestType>> functions;
  std::vector<Image> images;
  for (std::size_t i = 0; i < count; ++i) {
    images.push_back(random_image(16, static_cast<unsigned>(30 + i)));
    functions.push_back(set_of<TestType>(images.back()));
  }
  const Image product = product_image(images);
  const double expected = integral_of(product);
  const double limit = tolerance<TestType> * largest(product);
  const std::span<const CoefficientSet<TestType>> all(functions);
  CAPTURE(count, expected);
  CHECK(expected > 0.001 * largest(product)); // else the limit would mean nothing
  const auto chained = multiply(all);
  CHECK(std::abs(static_cast<double>(chained.root) - expected) < limit);
  CHECK(largest_difference(dense(chained, 4), product) < limit);
  for (std::size_t k = 1; k < count; ++k)
    CHECK(std::abs(static_cast<double>(factored_integral(all, k)) - expected) < limit);
  while (functions.size() > 1) { // neighbours two by two
    for (std::size_t i = 0; i + 1 < functions.size(); ++i) {
      functions[i] = multiply(functions[i], functions[i + 1]);
      functions.erase(functions.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
  }
  CHECK(std::abs(static_cast<double>(functions[0].root) - expected) < limit);
}

TEMPLATE_TEST_CASE("reference: the theorem's sum over n-tuples is the factored integral", "", float,
                   double) {
  const std::size_t count = GENERATE(1, 2, 3, 4, 5, 7);
  const int wavelets = count < 5 ? 12 : count < 7 ? 8 : 5;
  for (unsigned seed = 0; seed < 3; ++seed) {
    std::vector<CoefficientSet<TestType>> functions;
    std::vector<Image> images;
    for (std::size_t i = 0; i < count; ++i) {
      const auto number = static_cast<unsigned>(i);
      functions.push_back(sparse_set<TestType>(4, wavelets, 10 * seed + number));
      functions.back().details[{0, 0, 0}][(seed + number) % 3] += TestType(0.5);
      images.push_back(dense(functions.back(), 4));
    }
    const double expected = integral_of(product_image(images));
    const double limit = tolerance<TestType> * largest(product_image(images));
    const std::span<const CoefficientSet<TestType>> all(functions);
    CHECK(std::abs(integral_by_theorem(all) - expected) < limit);
    for (std::size_t k = 1; k < count; ++k)
      CHECK(std::abs(static_cast<double>(factored_integral(all, k)) - expected) < limit);
  }
}

TEST_CASE("reference: the inner product is the integral of the product, either way round") {
  const auto f = sparse_set<double>(5, 60, 1);
  const auto g = sparse_set<double>(4, 200, 2);
  CHECK(inner_product(f, g) == Approx(multiply(f, g).root).epsilon(1e-12));
  CHECK(inner_product(f, g) == Approx(inner_product(g, f)).epsilon(1e-12));
  CHECK(inner_product(f, g) == Approx(integral_of(dense(f, 5), dense(g, 5))).epsilon(1e-12));
}

TEST_CASE("reference: the integral of the synchronous product is OPPRODUCT at the root") {
  for (const double dropped : {0.0, 0.05, 0.3})
    for (unsigned seed = 0; seed < 4; ++seed) {
      const Tree light = tree_of(random_map(64, seed), dropped, CoefficientType::Half);
      const Tree lobe = tree_of(lobes(32), dropped / 10, CoefficientType::Half);
      const Rgb found = product_of(light.view(), lobe.view()).integral();
      const Scalars l(light);
      const Scalars r(lobe);
      for (int c = 0; c < 3; ++c)
        CHECK(static_cast<double>(found[c]) ==
              Approx(Product<double>(l.of[c], r.of[c]).average({})).epsilon(1e-5));
    }
}

TEST_CASE("reference: the density of the synchronous product is OPPRODUCT at every square") {
  const double dropped = GENERATE(0.0, 0.02);
  Map map = random_map(64, 5);
  for (float& value : map.rgb)
    value += 0.5F;
  const Tree light = tree_of(map, dropped, CoefficientType::Half);
  const Tree lobe = tree_of(lobes(64), dropped, CoefficientType::Half);
  const Image light_image = channel_image(light.view().reconstruct(6), Channel::Luminance);
  const Image lobe_image = channel_image(lobe.view().reconstruct(6), Channel::Luminance);
  REQUIRE(*std::min_element(light_image.begin(), light_image.end()) > 0.25); // no floor …
  REQUIRE(*std::min_element(lobe_image.begin(), lobe_image.end()) > 0.1);    // … comes into play
  const ProductTree table = product_of(light.view(), lobe.view());
  Image density;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      density.push_back(
          table.pdf((static_cast<float>(x) + 0.5F) / 64, (static_cast<float>(y) + 0.5F) / 64));
  const Scalars l(light);
  const Scalars r(lobe);
  std::vector<Product<double>> products;
  for (int c = 0; c < 3; ++c)
    products.emplace_back(l.of[c], r.of[c]);
  const auto average = [&](const Square& s) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      sum += static_cast<double>(luminance_weights[c]) * products[c].average(s);
    return sum;
  };
  double error = 0;
  for_each_square(6, [&](const Square& s) {
    const double expected = average(s) / average({});
    error = std::max(error, std::abs(average_of(density, s) - expected) / expected);
  });
  CHECK(error < 1e-4);
}
