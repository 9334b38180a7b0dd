// Visibility trees against the rays they stand for.

#include "occluders.h"

#include <renderer/visibility/visibility.h>

#include <wavelet/product/multiply.h>
#include <wavelet/square/sphere_map.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <string>

using namespace haarlight;
using namespace haarlight::renderer;
using wavelet::Tree;

namespace {

constexpr int levels = 7;

ShapeSet only(const Pair& pair) {
  ShapeSet set;
  set.add(pair.shape, pair.transform);
  return set;
}

/// How a tree of visibility compares with rays into random directions of the light's frame.
struct Comparison {
  int clear = 0; ///< the tree says 0 or 1
  int wrong = 0; ///< of those, not as the ray
  double rays = 0;
  double mean = 0; ///< of the tree's values there
};

template <class Visible>
Comparison compare(const Tree& tree, const Visible& visible) {
  constexpr int count = 20000;
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  Comparison result;
  for (int i = 0; i < count; ++i) {
    const Vec2 p(uniform(generator), uniform(generator));
    const bool seen = visible(turned_light().to_world(wavelet::square_to_sphere(p)));
    const float value = tree.view().value(p.x(), p.y())[0];
    result.rays += (seen ? 1.0 : 0.0) / count;
    result.mean += static_cast<double>(value) / count;
    if (value > 1e-5F && value < 1 - 1e-5F)
      continue;
    ++result.clear;
    result.wrong += (value > 0.5F) != seen ? 1 : 0;
  }
  return result;
}

} // namespace

TEST_CASE("visibility trees of objects agree with rays", "[visibility]") {
  for (const Pair& pair : pairs()) {
    INFO(pair.name);
    const ShapeSet set = both(pair);
    const ShapeSet other = only(pair);
    const Hit hit = top_of_sphere();
    const VisibilityTrees trees(set, turned_light());
    const Tree tree = trees.object(1, hit, levels);
    const Vec3 origin = leave(hit, hit.normal).origin;
    const Comparison result = compare(tree, [&](const Vec3& w) {
      return !other.occluded({origin, w});
    });
    // Sixteen rays may all miss what a sliver of a square holds.
    CHECK(result.wrong <= (std::holds_alternative<Sphere>(pair.shape) ? 0 : 20));
    CHECK(result.clear > 18000);
    CHECK(result.mean == Approx(result.rays).margin(2e-3));
    CHECK(tree.channels == 1);
  }
}

TEST_CASE("visibility trees of spheres and planes have their solid angles", "[visibility]") {
  const Hit hit = top_of_sphere();
  for (const double radius : {0.05, 0.4, 0.9}) {
    const Pair pair = {"", Sphere{Vec3(0.6F, 0.9F, 0), static_cast<float>(radius)}};
    const ShapeSet set = both(pair);
    const VisibilityTrees trees(set, turned_light());
    const double sine = radius / std::hypot(0.6, 0.8);
    const double hidden = 0.5 * (1 - std::sqrt(1 - sine * sine));
    for (const int level : {4, 6, 8})
      CHECK(1 - static_cast<double>(trees.object(1, hit, level).mean[0]) ==
            Approx(hidden).epsilon(2e-4));
  }
  const Pair plane = {"", Plane{Vec3(0, 2, 0), Vec3(0.3F, 1, -0.2F)}};
  const ShapeSet set = both(plane);
  const VisibilityTrees trees(set, turned_light());
  CHECK(trees.object(1, hit, levels).mean[0] == Approx(0.5).epsilon(1e-4));
}

TEST_CASE("from within a sphere nothing is visible, and half of all beside it", "[visibility]") {
  Hit hit = top_of_sphere();
  const ShapeSet around = both({"", Sphere{Vec3::Zero(), 2}});
  CHECK(VisibilityTrees(around, turned_light()).object(1, hit, levels).mean[0] == 0);
  const ShapeSet close = both({"", Sphere{Vec3(0, 1.11F, 0), 1}});
  CHECK(VisibilityTrees(close, turned_light()).object(1, hit, levels).mean[0] ==
        Approx(0.5 + 0.5 * std::sqrt(1 - 1 / (1.01 * 1.01))).epsilon(1e-4));
}

TEST_CASE("an object's own visibility ends at its horizon", "[visibility]") {
  const ShapeSet set = both(pairs()[0]);
  Hit hit = top_of_sphere();
  hit.normal = Vec3(0.3F, 0.8F, -0.4F).normalized();
  const VisibilityTrees trees(set, turned_light());
  const Comparison result =
      compare(trees.own(hit, levels), [&](const Vec3& w) { return w.dot(hit.normal) > 0; });
  CHECK(result.wrong == 0);
  for (const int level : {0, 3, 6, 7}) {
    CHECK(trees.own(hit, level).mean[0] == Approx(0.5).epsilon(1e-4));
  }
}

TEST_CASE("a torus occludes itself", "[visibility]") {
  const Pair ring = {"", Torus{Vec3(0, 0, 0), Vec3(0.2F, 1, 0.1F), 1, 0.4F}};
  const ShapeSet set = only(ring);
  const VisibilityTrees trees(set, turned_light());
  Hit hit;
  REQUIRE(set.intersect({Vec3(0, 0, 0), Vec3(1, 0.1F, 0.2F).normalized()}, hit));
  const Tree tree = trees.own(hit, levels);
  const Comparison result = compare(
      tree, [&](const Vec3& w) { return w.dot(hit.normal) > 0 && !set.occluded(leave(hit, w)); });
  CHECK(result.rays < 0.4);
  CHECK(result.rays > 0.1);
  CHECK(result.wrong < 40);
  CHECK(result.clear > 18000);
  CHECK(result.mean == Approx(result.rays).margin(2e-3));
}

TEST_CASE("the product of visibilities is the visibility past all objects", "[visibility]") {
  ShapeSet set;
  set.add(Sphere{Vec3::Zero(), 0.1F});
  set.add(Sphere{Vec3(0.6F, 0.7F, -0.4F), 0.5F});
  set.add(Sphere{Vec3(0.1F, 1, 0), 0.4F});
  set.add(Plane{Vec3(0, -0.2F, 0), Vec3(0.1F, 1, 0)});
  const Hit hit = top_of_sphere();
  const VisibilityTrees trees(set, turned_light());
  const Tree parts[] = {trees.own(hit, levels), trees.object(1, hit, levels),
                        trees.object(2, hit, levels), trees.object(3, hit, levels)};
  const Tree all = wavelet::multiply(
      std::vector{parts[0].view(), parts[1].view(), parts[2].view(), parts[3].view()});
  const Comparison result = compare(
      all, [&](const Vec3& w) { return w.dot(hit.normal) > 0 && !set.occluded(leave(hit, w)); });
  CHECK(result.wrong == 0);
  CHECK(result.mean == Approx(result.rays).margin(2e-3));
}

TEST_CASE("occluder trees are those of objects that occlude the hemisphere of a point",
          "[visibility]") {
  ShapeSet set;
  set.add(Sphere{Vec3::Zero(), 0.1F}); // the shaded object
  set.add(Sphere{Vec3(0.6F, 0.7F, -0.4F), 0.5F});
  set.add(Sphere{Vec3(0, -3, 0), 0.5F}); // below the horizon
  const Hit hit = top_of_sphere();
  const VisibilityTrees visibility(set, turned_light());
  OccluderTrees occluders(visibility, set.size(), levels);
  const auto trees = occluders.at(hit);
  REQUIRE(trees.size() == 1);
  CHECK(trees[0].mean[0] == visibility.object(1, hit, levels).mean[0]);
  CHECK(occluders.at(hit, 1).empty());
}
