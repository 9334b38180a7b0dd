// Regions as trees: caps of known area, squares' bounds, and the algebra of visibilities.

#include <wavelet/product/multiply.h>
#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::wavelet;

namespace {

/// Directions w with w·axis > cosine: classified by bounds, covered by quadrature.
class TestCap : public Region {
public:
  TestCap(const Vec3& axis, float angle)
      : m_axis(axis.normalized()), m_angle(angle), m_cosine(std::cos(angle)) {}

  RegionPart classify(const Square& square) const override {
    const SquareCap cap = square_cap(square);
    const float radius = std::acos(cap.cosine);
    const float away = std::acos(std::clamp(m_axis.dot(cap.centre), -1.0F, 1.0F));
    if (away + radius <= m_angle)
      return RegionPart::Inside;
    return away - radius >= m_angle ? RegionPart::Outside : RegionPart::Partial;
  }

  float coverage(const Square& square) const override {
    return positive_fraction_of(square, [&](Float4 x, Float4 y, Float4 z) {
      return x * m_axis.x() + y * m_axis.y() + z * m_axis.z() - m_cosine;
    });
  }

  bool holds(const Vec3& w) const { return w.dot(m_axis) > m_cosine; }
  double share() const { return 0.5 * (1 - std::cos(static_cast<double>(m_angle))); }

private:
  Vec3 m_axis;
  float m_angle;
  float m_cosine;
};

std::vector<TestCap> caps() {
  std::vector<TestCap> result;
  for (const float angle : {0.02F, 0.1F, 0.4F, 1.0F, 1.5707963F, 2.0F, 3.0F})
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.3F, -0.5F, 0.2F),
                             Vec3(-0.7F, 0.1F, -0.6F), Vec3(1, 1, 0.01F)})
      result.emplace_back(axis, angle);
  return result;
}

/// The average over a square by 64 × 64 points.
double dense_share(const TestCap& cap, const Square& square) {
  constexpr int points = 64;
  const float side = power_of_two(-square.level);
  int inside = 0;
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i) {
      const float u = (static_cast<float>(square.column) + (static_cast<float>(i) + 0.5F) / points);
      const float v = (static_cast<float>(square.row) + (static_cast<float>(j) + 0.5F) / points);
      inside += cap.holds(square_to_sphere(Vec2(u * side, v * side))) ? 1 : 0;
    }
  return static_cast<double>(inside) / (points * points);
}

float checkerboard(const Square& square) { return (square.column + square.row) % 3 == 0; }

/// Nothing but noise at the finest level.
class Checkerboard : public Region {
public:
  RegionPart classify(const Square&) const override { return RegionPart::Partial; }
  float coverage(const Square& square) const override { return checkerboard(square); }
};

} // namespace

TEST_CASE("the bounds of squares hold all their directions", "[region]") {
  for (int level = 0; level <= 6; ++level)
    for (std::uint32_t row = 0; row < 1U << level; ++row)
      for (std::uint32_t column = 0; column < 1U << level; ++column) {
        const SquareCap cap = square_cap({level, column, row});
        float lowest = 1;
        for (int j = 0; j <= 8; ++j)
          for (int i = 0; i <= 8; ++i) {
            const float side = power_of_two(-level);
            const Vec2 p((static_cast<float>(column) + static_cast<float>(i) / 8) * side,
                         (static_cast<float>(row) + static_cast<float>(j) / 8) * side);
            lowest = std::min(lowest, cap.centre.dot(square_to_sphere(p)));
          }
        REQUIRE(lowest >= cap.cosine - 1e-6F);
        REQUIRE(cap.cosine * cap.cosine + cap.sine * cap.sine == Approx(1).margin(1e-5));
        if (level >= 2) // and are not much too wide
          REQUIRE(1 - cap.cosine < 1.05F * (1 - lowest) + 1e-6F);
      }
}

TEST_CASE("trees of caps have the caps' solid angles", "[region]") {
  for (const TestCap& cap : caps())
    for (const int levels : {0, 2, 5, 7}) {
      const Tree tree = region_tree(cap, levels);
      CAPTURE(cap.share(), levels);
      CHECK(static_cast<double>(tree.mean[0]) == Approx(cap.share()).epsilon(1e-4).margin(1e-6));
    }
}

TEST_CASE("finest squares of a cap's tree hold their share of it", "[region]") {
  double worst = 0;
  for (const TestCap& cap : {caps()[9], caps()[16], caps()[27]}) {
    const Tree tree = region_tree(cap, 5);
    for (std::uint32_t row = 0; row < 32; ++row)
      for (std::uint32_t column = 0; column < 32; ++column) {
        const double value = static_cast<double>(
            tree.view().average(5, static_cast<int>(column), static_cast<int>(row))[0]);
        worst = std::max(worst, std::abs(value - dense_share(cap, {5, column, row})));
      }
  }
  CHECK(worst < 0.012); // what 64 × 64 points are off by along an edge
  CHECK(worst > 0);
}

TEST_CASE("region trees are sparse and hold what was asked for", "[region]") {
  const Tree cap = region_tree(TestCap(Vec3(0.3F, -0.5F, 0.2F), 0.4F), 9);
  CHECK(cap.links.size() < 4000); // of 87381
  CHECK(cap.level_begin.size() == 10);
  Tree noise;
  RegionTreeBuilder builder;
  builder.build(TestCap(Vec3(0, 0, 1), 1), 6, noise); // of which nothing may stay
  builder.build(Checkerboard(), 4, noise);
  for (std::uint32_t row = 0; row < 16; ++row)
    for (std::uint32_t column = 0; column < 16; ++column)
      CHECK(noise.view().average(4, static_cast<int>(column), static_cast<int>(row))[0] ==
            Approx(checkerboard({4, column, row})).margin(1e-6));
}

TEST_CASE("products of region trees are intersections", "[region]") {
  const TestCap a(Vec3(0.3F, -0.5F, 0.2F), 1.2F);
  const TestCap b(Vec3(0.5F, 0.3F, 0.4F), 1.0F);
  const TestCap not_a(Vec3(-0.3F, 0.5F, -0.2F), pi - 1.2F);
  const Tree ta = region_tree(a, 7);
  const Tree tb = region_tree(b, 7);
  const Tree complement = region_tree(not_a, 7);
  const Tree both = multiply(std::vector{ta.view(), tb.view()});
  const Tree only_b = multiply(std::vector{complement.view(), tb.view()});
  CHECK(ta.mean[0] + complement.mean[0] == Approx(1).margin(1e-5));
  CHECK(both.mean[0] + only_b.mean[0] == Approx(tb.mean[0]).margin(1e-5));
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  int inside = 0;
  int unclear = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec2 p(uniform(generator), uniform(generator));
    const Vec3 w = square_to_sphere(p);
    const float value = both.view().value(p.x(), p.y())[0];
    inside += a.holds(w) && b.holds(w) ? 1 : 0;
    const bool clear = value < 1e-6F || value > 1 - 1e-6F;
    unclear += clear ? 0 : 1;
    if (clear)
      CHECK((value > 0.5F) == (a.holds(w) && b.holds(w)));
  }
  CHECK(unclear < 600);
  CHECK(inside > 1000);
  CHECK(static_cast<double>(both.mean[0]) == Approx(inside / 20000.0).margin(0.01));
}
