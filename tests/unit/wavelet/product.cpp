#include "lobe_trees.h"
#include "product_of.h"
#include "random_map.h"

#include <catch2/catch.hpp>

#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

double luminance_of_product(const Map& a, const Map& b, int x, int y) {
  return static_cast<double>(luminance(a.at(x, y) * b.at(x, y)));
}

/// The plain way to the table product: multiply pixels.
Map dense_product(const Map& light, const Map& reflectance, const SquareSymmetry& symmetry) {
  Map result(light.size);
  for (int y = 0; y < light.size; ++y)
    for (int x = 0; x < light.size; ++x) {
      const Vec2 p =
          symmetry.to_stored(Vec2((static_cast<float>(x) + 0.5F) / static_cast<float>(light.size),
                                  (static_cast<float>(y) + 0.5F) / static_cast<float>(light.size)));
      const auto size = static_cast<float>(light.size);
      const Rgb value =
          reflectance.at(static_cast<int>(p.x() * size), static_cast<int>(p.y() * size));
      result.set(x, y, light.at(x, y) * value);
    }
  return result;
}

} // namespace

TEST_CASE("products in one frame have the integral of the dense product") {
  for (const double tolerance : {0.0, 0.1}) {
    const Tree light = tree_of(random_map(32, 1), tolerance);
    const Tree lobe = tree_of(lobe_map(32, 0), tolerance);
    for (int turns = 0; turns < 4; ++turns)
      for (const bool mirrored : {false, true}) {
        const SquareSymmetry symmetry = {turns, mirrored};
        const ProductTree product = product_of(light.view(), lobe.view(), symmetry);
        const Map dense =
            dense_product(light.view().reconstruct(5), lobe.view().reconstruct(5), symmetry);
        const Rgb expected = map_mean(dense).cast<float>();
        CHECK(((product.integral() - expected) / expected).abs().maxCoeff() < 1e-5F);
      }
  }
}

TEST_CASE("the density of a product in one frame is the product's luminance") {
  const Map light = random_map(32, 3);
  const Map lobe = lobe_map(32, 0);
  const Tree light_tree = tree_of(light, 0);
  const Tree lobe_tree = tree_of(lobe, 0);
  const ProductTree product = product_of(light_tree.view(), lobe_tree.view());
  const double total = luminance(product.integral());
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const double expected = luminance_of_product(light, lobe, x, y) / total;
      const double pdf =
          product.pdf((static_cast<float>(x) + 0.5F) / 32, (static_cast<float>(y) + 0.5F) / 32);
      if (expected > 0.05) // above the floors
        CHECK(pdf == Approx(expected).epsilon(0.02));
      CHECK(pdf > 0);
    }
}

TEST_CASE("products in one frame sample what their pdf says") {
  const Tree light = tree_of(random_map(64, 4), 0.2);
  const Tree lobe = tree_of(lobe_map(64, 0), 0.05);
  const ProductTree product = product_of(light.view(), lobe.view(), {1, true});
  const auto result = chi_square_of(product, 8);
  CHECK(result.pdf_sum == Approx(1).margin(1e-3));
  CHECK(result.statistic < result.limit);
}

TEST_CASE("a pyramid's look-ups are the tree's averages at square centres, at every level") {
  const Tree trees[2] = {tree_of(lobe_map(128, 0), 0), tree_of(lobe_map(128, 1), 0)};
  const TreeView views[2] = {trees[0].view(), trees[1].view()};
  const Pyramid pyramid(views);
  for (int entry = 0; entry < 2; ++entry)
    for (int level = 0; level <= 7; ++level)
      for (int y = 0; y < (1 << level); y += 3)
        for (int x = 0; x < (1 << level); x += 3) {
          const float side = 1.0F / static_cast<float>(1 << level);
          const Float4 value = pyramid.lookup(entry, level, (static_cast<float>(x) + 0.5F) * side,
                                              (static_cast<float>(y) + 0.5F) * side);
          const Rgb average = views[entry].average(level, x, y);
          if (std::abs(value[0] - average[0]) > 0.005F * std::abs(average[0]) + 1e-4F)
            FAIL("level " << level << " at " << x << ", " << y << ": " << value[0] << ", not "
                          << average[0]);
        }
  CHECK(pyramid.lookup(0, 0, 0.5F, 0.5F)[3] > 1); // the lobe: a deviation far above the mean
}

TEST_CASE("a pyramid's deviation is that of the pixels under a square") {
  const Map map = random_map(32, 6);
  const Tree tree = tree_of(map, 0);
  const TreeView view = tree.view();
  const Pyramid pyramid(std::span(&view, 1));
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      double sum = 0;
      double square = 0;
      for (int j = 8 * y; j < 8 * y + 8; ++j)
        for (int i = 8 * x; i < 8 * x + 8; ++i) {
          const double value = luminance(map.at(i, j));
          sum += value / 64;
          square += value * value / 64;
        }
      const float found = pyramid.lookup(0, 2, (static_cast<float>(x) + 0.5F) / 4,
                                         (static_cast<float>(y) + 0.5F) / 4)[3];
      CHECK(found == Approx(std::sqrt(square - sum * sum)).epsilon(0.01));
    }
}

TEST_CASE("adaptive products integrate what dense quadrature integrates") {
  const Map light = random_map(256, 8);
  const Tree light_tree = tree_of(light, 0);
  const Tree lobes[2] = {tree_of(lobe_map(256, 0), 1e-4), tree_of(lobe_map(256, 1), 1e-4)};
  const TreeView views[2] = {lobes[0].view(), lobes[1].view()};
  const Pyramid pyramid(views);
  AdaptiveProduct builder(light_tree.view());
  std::mt19937 generator(2);
  std::normal_distribution<float> gauss;
  for (int i = 0; i < 10; ++i) {
    const Vec3 n = Vec3(gauss(generator), gauss(generator), gauss(generator)).normalized();
    Vec3 wo = Vec3(gauss(generator), gauss(generator), gauss(generator)).normalized();
    if (n.dot(wo) < 0)
      wo = -wo;
    const auto reflectance = reflectance_at(pyramid, n, wo, 0.25F);
    double expected = 0;
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const Vec3 w = square_to_sphere(
            Vec2((static_cast<float>(x) + 0.5F) / 256, (static_cast<float>(y) + 0.5F) / 256));
        const float z = reflectance.reflection.frame.n.dot(w);
        if (n.dot(w) > -0.02F) // the map knows no horizon of its own; the builder cuts just below
          expected += luminance(light.at(x, y) * Rgb(1.0F, 0.8F, 0.5F)) * 0.875 *
                      (30 * std::exp(40 * (z - 1)) + 0.1 * std::max(0.0F, z)) / 65536;
      }
    AdaptiveOptions fine;
    fine.variance_bound = 1e-3F;
    fine.max_leaves = 20000;
    CHECK(luminance(builder.build(reflectance, fine).integral()) == Approx(expected).epsilon(0.02));
  }
}

TEST_CASE("adaptive products sample what their pdf says, everywhere above the horizon") {
  const Tree light = tree_of(random_map(256, 9), 0.1);
  const Tree lobes[2] = {tree_of(lobe_map(256, 0), 0.01), tree_of(lobe_map(256, 1), 0.01)};
  const TreeView views[2] = {lobes[0].view(), lobes[1].view()};
  const Pyramid pyramid(views);
  AdaptiveProduct builder(light.view());
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  const Vec3 normals[3] = {Vec3::UnitY(), Vec3(0.6F, 0, -0.8F), Vec3(-0.48F, 0.6F, 0.64F)};
  for (const Vec3& n : normals) {
    const Vec3 wo = (n + 0.9F * frame_about(n).t).normalized();
    const ProductTree& product = builder.build(reflectance_at(pyramid, n, wo, 0.5F), {});
    CHECK(product.leaf_count() > 64);
    const auto result = chi_square_of(product, 16);
    CHECK(result.pdf_sum == Approx(1).margin(2e-3));
    CHECK(result.statistic < result.limit);
    for (int i = 0; i < 20000; ++i) {
      const Vec2 p(uniform(generator), uniform(generator));
      if (n.dot(square_to_sphere(p)) > 0)
        REQUIRE(product.pdf(p.x(), p.y()) > 0);
    }
  }
}

TEST_CASE("a tighter bound makes more leaves and a density closer to the product") {
  const Map light = random_map(256, 10);
  const Tree light_tree = tree_of(light, 0);
  const Tree lobe = tree_of(lobe_map(256, 0), 1e-4);
  const TreeView views[2] = {lobe.view(), lobe.view()};
  const Pyramid pyramid(views);
  AdaptiveProduct builder(light_tree.view());
  const auto reflectance = reflectance_at(pyramid, Vec3::UnitZ(), Vec3(0.6F, 0, 0.8F), 0);
  double variance = 1e9;
  std::size_t leaves = 0;
  for (const float bound : {0.5F, 0.1F, 0.02F}) {
    AdaptiveOptions options;
    options.variance_bound = bound;
    const ProductTree& product = builder.build(reflectance, options);
    double mean = 0;
    double square = 0;
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const Vec2 p((static_cast<float>(x) + 0.5F) / 256, (static_cast<float>(y) + 0.5F) / 256);
        const Vec3 w = square_to_sphere(p);
        const float z = reflectance.reflection.frame.n.dot(w);
        const double f = luminance(light.at(x, y) * Rgb(1.0F, 0.8F, 0.5F)) *
                         (30 * std::exp(40 * (z - 1)) + 0.1 * std::max(0.0F, z));
        if (w.z() <= 0)
          continue;
        mean += f / 65536;
        square += f * f / static_cast<double>(product.pdf(p.x(), p.y())) / 65536;
      }
    CHECK(square / (mean * mean) - 1 < variance);
    variance = square / (mean * mean) - 1;
    CHECK(product.leaf_count() > leaves);
    leaves = product.leaf_count();
    CHECK(variance < 3 * bound + 0.05);
  }
}

TEST_CASE("nothing to sample is said so") {
  const Tree light = tree_of(Map(16), 0);
  const Tree lobe = tree_of(lobe_map(16, 0), 0);
  const TreeView views[2] = {lobe.view(), lobe.view()};
  const Pyramid pyramid(views);
  AdaptiveProduct builder(light.view());
  CHECK(builder.build(reflectance_at(pyramid, Vec3::UnitZ(), Vec3::UnitZ(), 0), {}).empty());
  CHECK(product_of(light.view(), lobe.view()).empty());
}

TEST_CASE("folded rolls stand for the roll they should") {
  SetInfo info;
  info.kind = SetKind::Brdf;
  info.rolls = 16;
  info.rows = 4;
  info.fold = Fold::Rotations;
  CHECK(stored_roll(info, 3).row == 3);
  CHECK(stored_roll(info, 9).row == 1);
  CHECK(stored_roll(info, 9).symmetry.turns == 2);
  info.rows = 2;
  info.fold = Fold::Mirrors;
  CHECK(stored_roll(info, 1).row == 1);
  CHECK_FALSE(stored_roll(info, 1).symmetry.mirrored);
  CHECK(stored_roll(info, 6).row == 1);
  CHECK(stored_roll(info, 6).symmetry.turns == 1);
  CHECK(stored_roll(info, 6).symmetry.mirrored);
}

TEST_CASE("points and quadrants are turned alike") {
  for (int turns = 0; turns < 4; ++turns)
    for (const bool mirrored : {false, true}) {
      const SquareSymmetry symmetry = {turns, mirrored};
      for (unsigned q = 0; q < 4; ++q) {
        const Vec2 centre((q & 1U) != 0 ? 0.75F : 0.25F, (q & 2U) != 0 ? 0.75F : 0.25F);
        const Vec2 stored = symmetry.to_stored(centre);
        CHECK(symmetry.to_stored(q) ==
              (stored.x() > 0.5F ? 1U : 0U) + (stored.y() > 0.5F ? 2U : 0U));
      }
    }
}
