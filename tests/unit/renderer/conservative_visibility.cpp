// Estimates of what is seen of squares, against the rays they stand for.

#include "visibility/conservative_visibility.h"
#include "occluders.h"
#include "shapes/solid.h"
#include "visibility/ray_lanes.h"

#include <wavelet/square/sphere_map.h>

#include <catch2/catch.hpp>

#include <optional>
#include <random>

using namespace haarlight;
using namespace haarlight::renderer;
using detail::Lanes3;
using detail::Solid;
using detail::SolidKind;
using wavelet::Square;
using wavelet::SquareView;

namespace {

/// The share of a square above the horizon of a hit from which rays get by all shapes; none where
/// nothing lies above.
std::optional<double> ray_share(const ShapeSet& set, const Hit& hit, const Square& square) {
  constexpr std::uint32_t side = 16;
  const float step = power_of_two(-square.level) / side;
  int above = 0;
  int seen = 0;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const Vec2 p((static_cast<float>(side * square.column + i % side) + 0.5F) * step,
                 (static_cast<float>(side * square.row + i / side) + 0.5F) * step);
    const Vec3 w = turned_light().to_world(wavelet::square_to_sphere(p));
    if (hit.normal.dot(w) <= 0)
      continue;
    ++above;
    seen += set.occluded(leave(hit, w)) ? 0 : 1;
  }
  if (above == 0)
    return std::nullopt;
  return static_cast<double>(seen) / above;
}

/// Mean distance of the shares of all squares of a level from the rays'; checks that none is 0
/// where a ray gets through.
double mean_error(detail::ConservativeVisibility& squares, const ShapeSet& set, const Hit& hit,
                  int level) {
  const auto side = 1U << static_cast<unsigned>(level);
  double sum = 0;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const Square place = {level, i % side, i / side};
    SquareView view;
    squares.query_visibility({&place, 1}, {&view, 1});
    const std::optional<double> share = ray_share(set, hit, place);
    if (!share)
      continue;
    CHECK((view.seen > 0 || *share == 0));
    CHECK(view.seen <= 1);
    sum += std::abs(static_cast<double>(view.seen) - *share) / (side * side);
  }
  return sum;
}

} // namespace

TEST_CASE("visible fractions of squares agree with rays, and are 0 only where those are",
          "[seen]") {
  for (const Pair& pair : pairs()) {
    const ShapeSet set = both(pair);
    const Hit hit = top_of_sphere();
    detail::ConservativeVisibility squares(set, turned_light());
    squares.set_shading_point(hit);
    INFO(pair.name);
    CHECK(mean_error(squares, set, hit, 3) < 0.03);
    CHECK(mean_error(squares, set, hit, 5) < 0.015);
  }
}

TEST_CASE("the occluders of a quadrant are among those of its square", "[seen]") {
  for (const Pair& pair : pairs()) {
    INFO(pair.name);
    const ShapeSet set = both(pair);
    const Hit hit = top_of_sphere();
    detail::ConservativeVisibility squares(set, turned_light());
    squares.set_shading_point(hit);
    for (std::uint32_t i = 0; i < 64; ++i) {
      Square place = {3, i % 8, i / 8};
      SquareView whole;
      squares.query_visibility({&place, 1}, {&whole, 1});
      for (unsigned q = 0; q < 4; ++q) {
        place = Square{3, i % 8, i / 8}.quadrant(q);
        SquareView alone;
        SquareView view = {1, whole.occluders};
        squares.query_visibility({&place, 1}, {&alone, 1});
        squares.query_visibility({&place, 1}, {&view, 1});
        if (whole.seen > 0)
          CHECK(view.seen == alone.seen);
        CHECK((view.occluders & ~whole.occluders) == 0);
      }
    }
  }
}

TEST_CASE("intersections of four rays agree with those of single rays", "[seen]") {
  std::mt19937 generator(5);
  std::normal_distribution<float> normal;
  for (const SolidKind kind : {SolidKind::Sphere, SolidKind::Disk, SolidKind::Box,
                               SolidKind::Cylinder, SolidKind::Cone, SolidKind::Torus}) {
    Solid solid;
    solid.kind = kind;
    solid.tube = 0.2;
    int wrong = 0;
    int met = 0;
    constexpr int rounds = 5000;
    for (int round = 0; round < rounds; ++round) {
      Vec3 from(normal(generator), normal(generator), normal(generator));
      from *= 2.5F / from.norm();
      Lanes3 towards;
      for (int lane = 0; lane < 4; ++lane) {
        towards.x[lane] = 0.6F * normal(generator) - from.x();
        towards.y[lane] = 0.6F * normal(generator) - from.y();
        towards.z[lane] = 0.6F * normal(generator) - from.z();
      }
      const Int4 result = detail::rays_hit(solid, from, towards);
      for (int lane = 0; lane < 4; ++lane) {
        const Vec3 direction(towards.x[lane], towards.y[lane], towards.z[lane]);
        const bool truth = detail::canonical_distance(solid, from.cast<double>(),
                                                      direction.cast<double>()) < detail::no_hit;
        met += truth ? 1 : 0;
        wrong += truth != (result[lane] != 0) ? 1 : 0;
      }
    }
    INFO("kind " << static_cast<int>(kind));
    CHECK(met > rounds);
    CHECK(met < 4 * rounds - 1000);
    CHECK(wrong <= (kind == SolidKind::Torus ? 100 : 5));
  }
}
