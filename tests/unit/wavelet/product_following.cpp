// Adaptive products from point to point, and with something in the way.

#include "lobe_trees.h"
#include "product_of.h"
#include "random_map.h"

#include <wavelet/square/square_cap.h>

#include <catch2/catch.hpp>

#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// A light and a lobe, and two builders of their products.
struct Pair {
  explicit Pair(int size)
      : light(tree_of(random_map(size, 9), 0.1)), lobe(tree_of(lobe_map(size, 0), 0.01)) {}

  RotatedReflectance seen(const Vec3& n, const Vec3& wo, float blend) const {
    return reflectance_at(pyramid, n, wo, blend);
  }

  Tree light;
  Tree lobe;
  TreeView views[2] = {lobe.view(), lobe.view()};
  Pyramid pyramid{views};
  AdaptiveProduct following{light.view()};
  AdaptiveProduct fresh{light.view()};
};

} // namespace

TEST_CASE("products that may not drift are those that build() makes, and reach all they need") {
  const Tree light = tree_of(random_map(256, 9), 0.1);
  const Tree lobes[2] = {tree_of(lobe_map(256, 0), 0.01), tree_of(lobe_map(256, 1), 0.01)};
  const TreeView views[2] = {lobes[0].view(), lobes[1].view()};
  const Pyramid pyramid(views);
  AdaptiveProduct following(light.view());
  AdaptiveProduct fresh(light.view());
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int step = 0; step < 40; ++step) { // round half of the sphere, and once across it
    const float turn = step < 39 ? 0.08F * static_cast<float>(step) : -1.5F;
    const Vec3 n(std::cos(turn), 0.6F * std::sin(turn), 0.8F * std::sin(turn));
    const Vec3 wo = (n + 0.9F * frame_about(n).t).normalized();
    const auto reflectance = reflectance_at(pyramid, n, wo, 0.5F);
    const ProductTree& product = following.build_or_reuse(reflectance, {.reuse_variance_bound = 0});
    const ProductTree& built = fresh.build(reflectance, {});
    CHECK(product.leaf_count() == built.leaf_count());
    CHECK((product.integral() == built.integral()).all());
    for (int i = 0; i < 2000; ++i) {
      const Vec2 p(uniform(generator), uniform(generator));
      if (n.dot(square_to_sphere(p)) > 0)
        REQUIRE(product.pdf(p.x(), p.y()) > 0);
    }
    if (step % 13 != 12)
      continue;
    const auto result = chi_square_of(product, 16);
    CHECK(result.pdf_sum == Approx(1).margin(2e-3));
    CHECK(result.statistic < result.limit);
  }
}

TEST_CASE("products that are kept for points nearby reach all that these need, at little loss") {
  Pair pair(128);
  int kept = 0;
  float last = 0;
  for (int step = 0; step < 60; ++step) {
    const float turn = 0.003F * static_cast<float>(step);
    const Vec3 n(std::cos(turn), 0.6F * std::sin(turn), 0.8F * std::sin(turn));
    const Vec3 wo = (n + 1.5F * frame_about(n).t).normalized();
    const auto reflectance = pair.seen(n, wo, 0.5F);
    const ProductTree& product = pair.following.build_or_reuse(reflectance, {});
    const float integral = luminance(product.integral());
    kept += integral == last ? 1 : 0;
    last = integral;
    const ProductTree& own = pair.fresh.build(reflectance, {});
    double square = 0;
    double mass = 0;
    for (int i = 0; i < 128 * 128; ++i) {
      const Vec2 p((static_cast<float>(i % 128) + 0.5F) / 128,
                   (static_cast<float>(i / 128) + 0.5F) / 128);
      if (n.dot(square_to_sphere(p)) <= 0)
        continue;
      const auto target = static_cast<double>(own.pdf(p.x(), p.y()));
      const auto density = static_cast<double>(product.pdf(p.x(), p.y()));
      REQUIRE(density > 0);
      square += target * target / density;
      mass += target;
    }
    CHECK(square * 128 * 128 / (mass * mass) < 1.05);
  }
  CHECK(kept > 10);
  CHECK(kept < 59);
}

namespace {

/// Everything on one side of a plane.
class HalfHidden : public SquareVisibility {
public:
  explicit HalfHidden(const Vec3& side) : m_side(side) {}
  bool hides(const Vec3& w) const { return m_side.dot(w) > 0; }
  void query_visibility(std::span<const Square> squares, std::span<SquareView> views) override {
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const float seen = positive_fraction_of(squares[i], [&](Float4 x, Float4 y, Float4 z) {
        return -(m_side.x() * x + m_side.y() * y + m_side.z() * z);
      });
      views[i] = {seen, views[i].occluders * (seen > 0 && seen < 1 ? 1 : 0)};
    }
  }

private:
  Vec3 m_side;
};

/// Second moment of the target's visible part over the density, relative to its squared mean.
/// @param n what lies below its horizon is no part of the target
double relative_square(const ProductTree& target, const ProductTree& density,
                       const HalfHidden& occlusion, const Vec3& n = Vec3::Zero()) {
  double square = 0;
  double mean = 0;
  for (int i = 0; i < 128 * 128; ++i) {
    const Vec2 p((static_cast<float>(i % 128) + 0.5F) / 128,
                 (static_cast<float>(i / 128) + 0.5F) / 128);
    const auto f = static_cast<double>(target.pdf(p.x(), p.y()));
    const Vec3 w = square_to_sphere(p);
    if (f <= 0 || occlusion.hides(w) || n.dot(w) < 0)
      continue;
    mean += f / (128 * 128);
    square += f * f / static_cast<double>(density.pdf(p.x(), p.y())) / (128 * 128);
  }
  return square / (mean * mean);
}

} // namespace

TEST_CASE("products that know what is in the way spend few samples there, and miss nothing") {
  Pair pair(128);
  for (int step = 0; step < 6; ++step) {
    const float turn = 0.02F * static_cast<float>(step);
    const Vec3 n(std::sin(turn), 0, std::cos(turn));
    const auto reflectance = pair.seen(n, n, 0);
    HalfHidden occlusion(Vec3(0.8F, 0.6F, 0.1F * static_cast<float>(step)));
    const ProductTree& all = pair.fresh.build(reflectance, {});
    const ProductTree& open = pair.following.build_or_reuse(reflectance, {}, &occlusion);
    CHECK(luminance(open.integral()) == Approx(luminance(all.integral())).epsilon(0.02));
    CHECK(relative_square(all, open, occlusion) < 10);
    CHECK(relative_square(all, all, occlusion) > 1.3 * relative_square(all, open, occlusion));
    const auto result = chi_square_of(open, 16);
    CHECK(result.pdf_sum == Approx(1).margin(2e-3));
    CHECK(result.statistic < result.limit);
    CHECK(relative_square(all, pair.following.build_or_reuse(reflectance, {}),
                          HalfHidden(Vec3::Zero())) < 1.1);
  }
}

TEST_CASE("products by what is seen of squares are near the visible part, and miss nothing") {
  Pair pair(128);
  const auto reflectance = pair.seen(Vec3::UnitZ(), Vec3::UnitZ(), 0);
  for (int step = 0; step < 6; ++step) {
    HalfHidden half(Vec3(0.8F, 0.6F, 0.1F * static_cast<float>(step)).normalized());
    const ProductTree& all = pair.fresh.build(reflectance, {});
    const ProductTree& open = pair.following.build(reflectance, {}, &half, VisibilityTest::Squares);
    CHECK(relative_square(all, open, half, Vec3::UnitZ()) < 1.25);
    CHECK(relative_square(all, all, half, Vec3::UnitZ()) > 1.5);
    const auto result = chi_square_of(open, 16);
    CHECK(result.pdf_sum == Approx(1).margin(2e-3));
    CHECK(result.statistic < result.limit);
    const ProductTree& followed = pair.following.build_or_reuse(reflectance, {});
    CHECK(relative_square(all, followed, HalfHidden(Vec3::Zero())) < 1.1);
  }
}

TEST_CASE("products that may not grow follow to far points all the same") {
  Pair pair(256);
  const AdaptiveOptions scarce = {.variance_bound = 1e-4F, .max_leaves = 300};
  for (int step = 0; step < 12; ++step) {
    const float turn = 0.5F * static_cast<float>(step);
    const Vec3 n(std::cos(turn), std::sin(turn), 0);
    const auto reflectance = pair.seen(n, n, 0);
    const Rgb kept = pair.following.build_or_reuse(reflectance, scarce).integral();
    CHECK(luminance(kept) ==
          Approx(luminance(pair.fresh.build(reflectance, scarce).integral())).epsilon(0.02));
  }
}

TEST_CASE("products of lights and lobes of any scale have the same density") {
  Map light = random_map(64, 9);
  Map lobe = lobe_map(64, 0);
  const auto scaled = [](Map map, float factor) {
    for (float& value : map.rgb)
      value *= factor;
    return map;
  };
  const Vec3 n = Vec3(0.3F, 0.2F, 1).normalized();
  const Vec3 wo = (n + 0.5F * frame_about(n).t).normalized();
  const auto densities = [&](float light_factor, float lobe_factor) {
    const Tree light_tree = tree_of(scaled(light, light_factor), 0);
    const Tree lobe_tree = tree_of(scaled(lobe, lobe_factor), 0);
    const TreeView views[2] = {lobe_tree.view(), lobe_tree.view()};
    const Pyramid pyramid(views);
    AdaptiveProduct product(light_tree.view());
    const ProductTree& tree = product.build(reflectance_at(pyramid, n, wo, 0.5F), {});
    std::vector<float> result;
    for (int i = 0; i < 200; ++i) {
      const auto k = static_cast<float>(i);
      const Descent d = tree.sample(std::fmod(k * 0.754878F, 1.0F), std::fmod(k * 0.56984F, 1.0F));
      REQUIRE(std::isfinite(d.x + d.u1 + d.u2 + d.pdf));
      const Vec2 p = end_point(d);
      CHECK(tree.pdf(p.x(), p.y()) == Approx(d.pdf).epsilon(1e-3));
      result.push_back(d.pdf);
    }
    return result;
  };
  const std::vector<float> expected = densities(1, 1);
  // Powers of two change no digit.
  for (const auto& [a, b] : {std::pair(0x1p-80F, 1.0F), std::pair(0x1p-70F, 0x1p-50F),
                             std::pair(1.0F, 0x1p-50F), std::pair(0x1p50F, 1.0F)}) {
    const std::vector<float> found = densities(a, b);
    INFO(a << " " << b);
    double difference = 0;
    for (std::size_t i = 0; i < found.size(); ++i)
      difference += static_cast<double>(std::abs(found[i] / expected[i] - 1));
    CHECK(difference / 200 < 0.01);
  }
  // Beyond these squares of values leave the range of float, which costs accuracy but no more.
  for (const auto& [a, b] : {std::pair(0x1p-133F, 1.0F), std::pair(1.0F, 0x1p-110F),
                             std::pair(0x1p100F, 1.0F), std::pair(0x1p90F, 0x1p-90F)})
    densities(a, b);
}
