// The integral theorems against dense integration. Basis functions take the values 0 and ±2^l, so
// that every dense integral here is exact and has to be met exactly.

#include "wavelet_reference_dense.h"

#include <catch2/catch.hpp>

#include <array>

using namespace haarlight::wavelet::reference;
using namespace reference_test;

namespace {

/// What a sampled tuple of functions is drawn about.
struct Draw {
  int functions;    ///< how many
  int finest_scale; ///< j0
  int type;         ///< of one function at the finest scale
};

/// A tuple whose supports mostly nest, so that many integrals do not vanish.
std::vector<BasisFunction> random_tuple(const Draw& draw, std::mt19937& generator) {
  const auto below = [&](int n) {
    return static_cast<int>(generator() % static_cast<unsigned>(n));
  };
  const auto any_square = [&](int level) {
    const auto column = static_cast<std::uint32_t>(below(1 << level));
    return Square{level, column, static_cast<std::uint32_t>(below(1 << level))};
  };
  const Square finest = any_square(draw.finest_scale);
  std::vector<BasisFunction> tuple = {{finest, draw.type}};
  while (static_cast<int>(tuple.size()) < draw.functions) {
    const int level = below(draw.finest_scale + 1);
    const int choice = below(20);
    if (choice < 10)
      tuple.push_back({finest, 1 + below(3)});
    else if (choice < 12)
      tuple.push_back(mother_scaling);
    else if (choice < 19)
      tuple.push_back({finest.ancestor(level), 1 + below(3)});
    else
      tuple.push_back({any_square(level), 1 + below(3)});
  }
  std::shuffle(tuple.begin(), tuple.end(), generator);
  return tuple;
}

double dense_integral(const std::vector<BasisFunction>& tuple, const Basis& basis) {
  Image product(basis.images[0].size(), 1.0);
  for (const BasisFunction& f : tuple)
    product = times(std::move(product), basis.images[basis.index_of(f)]);
  return integral_of(product);
}

double integral_of_three(const BasisFunction& a, const BasisFunction& b, const BasisFunction& c) {
  return product_integral(std::array{a, b, c});
}

} // namespace

TEST_CASE("reference: the integral of nothing but the square is its area, of one wavelet 0") {
  CHECK(product_integral({}) == 1);
  CHECK(product_integral(std::array{mother_scaling}) == 1);
  for (int m = 1; m <= 3; ++m)
    CHECK(product_integral(std::array{BasisFunction{{2, 1, 3}, m}}) == 0);
  CHECK(product_integral(std::array{BasisFunction{{3, 1, 5}, 0}}) == 0.125);
}

TEST_CASE("reference: all pairs of 8 x 8 integrate as densely, to 1 if equal and 0 if not") {
  const Basis basis(8);
  REQUIRE(basis.functions.size() == 64);
  int wrong = 0;
  for (std::size_t i = 0; i < 64; ++i)
    for (std::size_t j = 0; j < 64; ++j) {
      const double found = product_integral(std::array{basis.functions[i], basis.functions[j]});
      wrong += found != integral_of(basis.images[i], basis.images[j]) ? 1 : 0;
      wrong += found != (i == j ? 1 : 0) ? 1 : 0;
    }
  CHECK(wrong == 0);
}

TEST_CASE("reference: all triples of 8 x 8 integrate as densely, by both theorems") {
  const Basis basis(8);
  int wrong = 0;
  std::array<int, 4> nonzero = {}; // by the finest wavelet's type
  for (std::size_t i = 0; i < 64; ++i)
    for (std::size_t j = 0; j < 64; ++j) {
      const Image pair = times(basis.images[i], basis.images[j]);
      for (std::size_t k = 0; k < 64; ++k) {
        const auto& [a, b, c] =
            std::tie(basis.functions[i], basis.functions[j], basis.functions[k]);
        const double dense = integral_of(pair, basis.images[k]);
        wrong += integral_of_three(a, b, c) != dense ? 1 : 0;
        wrong += tripling_coefficient(a, b, c) != dense ? 1 : 0;
        nonzero[static_cast<std::size_t>(a.m)] += dense != 0 ? 1 : 0;
      }
    }
  CHECK(wrong == 0);
  // A mother scaling function with itself or with two of 63 wavelets; a wavelet in 42 triples of
  // one square, twice 129 with itself and a coarser function, 108 over two of a kind.
  CHECK(nonzero == std::array<int, 4>{64, 408, 408, 408});
}

TEST_CASE("reference: all quadruples of 8 x 8, regardless of order, integrate as densely") {
  const Basis basis(8);
  int wrong = 0;
  for (std::size_t i = 0; i < 64; ++i)
    for (std::size_t j = i; j < 64; ++j) {
      const Image two = times(basis.images[i], basis.images[j]);
      for (std::size_t k = j; k < 64; ++k) {
        const Image three = times(two, basis.images[k]);
        for (std::size_t n = k; n < 64; ++n) {
          const double found = product_integral(std::array{basis.functions[n], basis.functions[i],
                                                           basis.functions[k], basis.functions[j]});
          wrong += found != integral_of(three, basis.images[n]) ? 1 : 0;
        }
      }
    }
  CHECK(wrong == 0);
}

TEST_CASE("reference: tuples of 3, 5 and 7 integrate as densely at every finest scale and type") {
  const int levels = GENERATE(4, 5);
  const Basis basis(1 << levels);
  std::mt19937 generator(static_cast<unsigned>(levels));
  for (const int functions : {3, 5, 7})
    for (int finest_scale = 0; finest_scale < levels; ++finest_scale)
      for (int type = 1; type <= 3; ++type) {
        CAPTURE(levels, functions, finest_scale, type);
        int wrong = 0;
        int positive = 0;
        int negative = 0;
        for (int i = 0; i < 300; ++i) {
          const auto tuple = random_tuple({functions, finest_scale, type}, generator);
          const double dense = dense_integral(tuple, basis);
          wrong += product_integral(tuple) != dense ? 1 : 0;
          positive += dense > 0 ? 1 : 0;
          negative += dense < 0 ? 1 : 0;
        }
        CHECK(wrong == 0);
        CHECK(positive >= 15);
        if (finest_scale > 0)
          CHECK(negative >= 10);
      }
}

TEST_CASE("reference: two identical wavelets of each type under any third, at 16 x 16") {
  const Basis basis(16);
  for (int type = 1; type <= 3; ++type) {
    int wrong = 0;
    std::array<int, 4> nonzero = {};
    for (std::size_t i = 0; i < basis.functions.size(); ++i) {
      const BasisFunction& f = basis.functions[i];
      if (f.m != type)
        continue;
      const Image square = times(basis.images[i], basis.images[i]);
      for (std::size_t k = 0; k < basis.functions.size(); ++k) {
        const double dense = integral_of(square, basis.images[k]);
        wrong += integral_of_three(f, basis.functions[k], f) != dense ? 1 : 0;
        wrong += tripling_coefficient(basis.functions[k], f, f) != dense ? 1 : 0;
        nonzero[static_cast<std::size_t>(basis.functions[k].m)] += dense != 0 ? 1 : 0;
      }
    }
    CHECK(wrong == 0);
    CHECK(nonzero == std::array<int, 4>{85, 228, 228, 228}); // Σ_l 4^l and Σ_l l·4^l
  }
}

TEST_CASE("reference: the exponent of the theorem is not the one printed") {
  const Basis basis(32);
  for (int j0 = 0; j0 <= 4; ++j0)
    for (int type = 1; type <= 3; ++type) {
      const BasisFunction f = {{j0, (1U << j0) / 2, 0}, type};
      const std::vector<BasisFunction> tuple = {f, f, f, f};
      const double dense = dense_integral(tuple, basis);
      CHECK(product_integral(tuple) == dense);
      const double printed = std::pow(2.0, 4 * j0 - std::pow(2.0, j0));
      CHECK((printed == dense) == (j0 == 1 || j0 == 2));
    }
}

TEST_CASE("reference: a scaling function with any pair of 8 x 8 integrates by equation 28") {
  const Basis basis(8);
  int wrong = 0;
  for_each_square(3, [&](const Square& s) {
    const BasisFunction scaling = {s, 0};
    const Image image = basis_image(scaling, 8);
    for (std::size_t j = 0; j < 64; ++j) {
      const Image pair = times(image, basis.images[j]);
      for (std::size_t k = 0; k < 64; ++k) {
        const double dense = integral_of(pair, basis.images[k]);
        const auto& [g, h] = std::tie(basis.functions[j], basis.functions[k]);
        wrong += scaling_tripling_coefficient(s, g, h) != dense ? 1 : 0;
        wrong += integral_of_three(scaling, g, h) != dense ? 1 : 0;
      }
    }
  });
  CHECK(wrong == 0);
}

TEST_CASE("reference: signs are those of the transform, over every square inside") {
  for (int m = 1; m <= 3; ++m) {
    const Square outer = {1, 1, 0};
    const Image image = basis_image({outer, m}, 16);
    for_each_square(4, [&](const Square& s) {
      if (s.level > outer.level && outer.contains(s))
        CHECK(2 * sign_over(m, outer, s) == average_of(image, s));
    });
  }
}
