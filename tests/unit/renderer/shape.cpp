// The analytic shapes against signed distances, and how rays leave them.

#include "renderer_shape_reference.h"

#include <renderer/shapes/shapes.h>

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace haarlight;
using namespace haarlight::renderer;
using Eigen::Vector3d;

namespace {

struct Sample {
  std::string name;
  Shape shape;
  bool closed = true;
  bool convex = true;
};

std::vector<Sample> samples() {
  return {{"sphere", Sphere{Vec3(0.3F, -0.2F, 0.1F), 1.2F}},
          {"plane", Plane{Vec3(0.1F, -0.5F, 0.2F), Vec3(0.2F, 2, -0.3F)}, false},
          {"disk", Disk{Vec3(0, 0.2F, 0.1F), Vec3(1, 2, -3), 1.4F}, false},
          {"box", Box{Vec3(-1, -0.5F, -0.7F), Vec3(0.8F, 0.9F, 1.3F)}},
          {"cylinder", Cylinder{Vec3(-0.5F, -1, 0), Vec3(0.3F, 1.1F, 0.4F), 0.8F}},
          {"upright cylinder", Cylinder{Vec3(0, -1, 0), Vec3(0, 1, 0), 0.6F}},
          {"cone", Cone{Vec3(0.1F, -1, 0.2F), Vec3(0.5F, 1.2F, -0.4F), 1.1F}},
          {"torus", Torus{Vec3(0.1F, 0, -0.2F), Vec3(0.3F, 1, 0.5F), 1.1F, 0.4F}, true, false},
          {"thin torus", Torus{Vec3(0, 0, 0), Vec3(0, 0, 1), 1.5F, 0.02F}, true, false},
          {"fat torus", Torus{Vec3(0, 0, 0), Vec3(0, 1, 0), 1, 0.97F}, true, false}};
}

ShapeSet only(const Shape& shape, const AffineMap& transform = {}) {
  ShapeSet set;
  set.add(shape, transform);
  return set;
}

/// A ray with a fair chance to hit something about the origin.
Ray aimed_ray(reference::Random& random, float from) {
  const Vec3 origin = random.point(from);
  const Vec3 target = random.point(1.3F);
  return {origin, (target - origin).normalized()};
}

} // namespace

TEST_CASE("every shape is hit where its distance says", "[shape]") {
  for (const Sample& sample : samples()) {
    INFO(sample.name);
    const ShapeSet set = only(sample.shape);
    reference::Random random(1);
    int hits = 0;
    int unclear = 0;
    for (int i = 0; i < 4000; ++i) {
      const Ray ray = aimed_ray(random, i % 3 == 0 ? 1.0F : 6.0F);
      const Vector3d direction = ray.direction.cast<double>().normalized();
      const auto truth =
          reference::follow(sample.shape, ray.origin.cast<double>(), direction, 40.0);
      unclear += truth.answer == reference::Answer::Unclear ? 1 : 0;
      if (truth.answer == reference::Answer::Unclear)
        continue;
      Hit hit;
      const bool is_hit = set.intersect({ray.origin, ray.direction, 40}, hit);
      REQUIRE(is_hit == (truth.answer == reference::Answer::Hit));
      if (!is_hit)
        continue;
      ++hits;
      REQUIRE(hit.t == Approx(truth.t).epsilon(2e-6).margin(2e-6));
      REQUIRE(std::abs(reference::distance(sample.shape, hit.position.cast<double>())) < 4e-7);
      REQUIRE(hit.object == 0);
    }
    CHECK(hits > 50);
    CHECK(unclear < 20);
  }
}

TEST_CASE("normals are unit gradients of the distance", "[shape]") {
  for (const Sample& sample : samples()) {
    INFO(sample.name);
    const ShapeSet set = only(sample.shape);
    reference::Random random(2);
    int compared = 0;
    for (int i = 0; i < 4000; ++i) {
      Hit hit;
      if (!set.intersect(aimed_ray(random, 4), hit))
        continue;
      REQUIRE(hit.normal.norm() == Approx(1).epsilon(1e-6));
      const Vector3d p = hit.position.cast<double>();
      Vector3d truth = reference::normal(sample.shape, p, 1e-5);
      if (sample.name == "disk") // its distance has no sign, hence no gradient on it
        truth = Vector3d(1, 2, -3).normalized();
      else if ((truth - reference::normal(sample.shape, p, 1e-3)).norm() > 0.1)
        continue; // an edge within the larger step
      REQUIRE((hit.normal.cast<double>() - truth).norm() < 2e-3);
      ++compared;
    }
    CHECK(compared > 100);
  }
}

TEST_CASE("a ray that leaves a surface does not hit it again", "[shape]") {
  // Small and large, near the origin and far from it.
  const struct {
    double scale;
    Vector3d offset;
  } places[] = {{1, {0, 0, 0}},
                {1, {1000, -300, 50}},
                {1e-3, {5, 5, 5}},
                {1e5, {0, 1e5, 0}},
                {30, {-1e4, 20, 3}}};
  for (const Sample& sample : samples())
    for (const auto& place : places) {
      INFO(sample.name << " at scale " << place.scale);
      const AffineMap transform =
          scaling(Vector3d::Constant(place.scale)).then(translation(place.offset));
      const ShapeSet set = only(sample.shape, transform);
      reference::Random random(3);
      for (int i = 0; i < 1500; ++i) {
        Hit hit;
        const Ray local = aimed_ray(random, 5);
        const Ray ray{transform.point(local.origin.cast<double>()).cast<float>(), local.direction};
        if (!set.intersect(ray, hit))
          continue;
        Vec3 out = random.direction();
        out = out.dot(hit.normal) < 0 ? Vec3(-out) : out;
        if (sample.convex)
          REQUIRE_FALSE(set.occluded(leave(hit, out)));
        else if (out.dot(hit.normal) > 0.05F) // the hole's wall curves towards a grazing ray
          REQUIRE_FALSE(set.occluded(leave(hit, out, 1e-3F * static_cast<float>(place.scale))));
        const Ray inwards = leave(hit, -out);
        const Vector3d start = transform.inverse().point(inwards.origin.cast<double>());
        if (sample.closed && reference::distance(sample.shape, start) < 0) // not across an edge
          REQUIRE(set.occluded(inwards));
      }
    }
}

TEST_CASE("a huge sphere is flat and quiet at the origin", "[shape]") {
  const ShapeSet set = only(Sphere{Vec3(0, -1e6F, 0), 1e6F});
  reference::Random random(4);
  for (int i = 0; i < 2000; ++i) {
    Hit hit;
    const Vec3 above(random.between(-1, 1), 1, random.between(-1, 1));
    REQUIRE(set.intersect({above, -Vec3::UnitY()}, hit));
    REQUIRE(std::abs(hit.position.y()) < 1e-6F);
    Vec3 out = random.direction();
    out = out.dot(hit.normal) < 0 ? Vec3(-out) : out;
    REQUIRE_FALSE(set.occluded(leave(hit, out)));
  }
}

TEST_CASE("rays along axes and edges are no special case", "[shape]") {
  const ShapeSet box = only(Box{});
  const ShapeSet cylinder = only(Cylinder{Vec3(0, -1, 0), Vec3(0, 1, 0), 1});
  const ShapeSet cone = only(Cone{Vec3(0, -1, 0), Vec3(0, 1, 0), 1});
  const ShapeSet torus = only(Torus{});
  const ShapeSet plane = only(Plane{});
  Hit hit;
  REQUIRE(box.intersect({Vec3(0, 0, 5), -Vec3::UnitZ()}, hit));
  CHECK(hit.t == 4);
  CHECK(hit.normal == Vec3::UnitZ());
  CHECK_FALSE(box.intersect({Vec3(1.5F, 0, 5), -Vec3::UnitZ()}, hit));
  REQUIRE(cylinder.intersect({Vec3(0.5F, 5, 0), -Vec3::UnitY()}, hit));
  CHECK(hit.t == Approx(4));
  CHECK((hit.normal - Vec3::UnitY()).norm() < 1e-6F);
  CHECK_FALSE(cylinder.intersect({Vec3(1.5F, 5, 0), -Vec3::UnitY()}, hit));
  REQUIRE(cone.intersect({Vec3(0, 5, 0), -Vec3::UnitY()}, hit));
  CHECK(hit.t == Approx(4));
  REQUIRE(cone.intersect({Vec3(0.25F, -5, 0), Vec3::UnitY()}, hit));
  CHECK(hit.t == Approx(4));
  CHECK((hit.normal + Vec3::UnitY()).norm() < 1e-6F);
  CHECK_FALSE(torus.intersect({Vec3(0, 5, 0), -Vec3::UnitY()}, hit)); // through the hole
  REQUIRE(torus.intersect({Vec3(5, 0, 0), -Vec3::UnitX()}, hit));
  CHECK(hit.t == Approx(3.75));
  CHECK_FALSE(plane.intersect({Vec3(0, 1, 0), Vec3::UnitX()}, hit));
  CHECK_FALSE(plane.intersect({Vec3(0, 0, 0), Vec3::UnitX()}, hit));
}

TEST_CASE("a slanted ray along the cone's side still finds the base", "[shape]") {
  // The quadratic loses its leading coefficient for directions parallel to the side.
  const ShapeSet cone = only(Cone{Vec3(0, 0, 0), Vec3(0, 1, 0), 1});
  const Vec3 slope = Vec3(1, -1, 0).normalized();
  Hit hit;
  REQUIRE(cone.intersect({Vec3(-1, 1, 0), slope}, hit));
  CHECK((hit.position - Vec3(-0.5F, 0.5F, 0)).norm() < 1e-6F);
  REQUIRE(cone.intersect({Vec3(0, 0.5F, 0), slope}, hit));
  CHECK((hit.position - Vec3(0.5F, 0, 0)).norm() < 1e-6F);
}

TEST_CASE("occluded answers as intersect does, in a crowd and up to t_max", "[shape]") {
  ShapeSet set;
  reference::Random random(5);
  for (int copy = 0; copy < 3; ++copy)
    for (const Sample& sample : samples())
      if (sample.name != "plane")
        set.add(sample.shape,
                scaling(Vector3d::Constant(0.4)).then(translation(random.point(4).cast<double>())));
  set.add(Plane{Vec3(0, -5, 0), Vec3(0, 1, 0)});
  REQUIRE(set.size() == 28);
  std::vector<int> seen(28, 0);
  for (int i = 0; i < 20000; ++i) {
    Ray ray = aimed_ray(random, 8);
    ray.t_max = i % 2 == 0 ? ray.t_max : random.between(0, 12);
    Hit hit;
    const bool is_hit = set.intersect(ray, hit);
    REQUIRE(set.occluded(ray) == is_hit);
    if (!is_hit)
      continue;
    REQUIRE(hit.t < ray.t_max * 1.000001F);
    REQUIRE_FALSE(set.occluded({ray.origin, ray.direction, hit.t * 0.99999F}));
    ++seen[static_cast<std::size_t>(hit.object)];
  }
  CHECK(std::count_if(seen.begin(), seen.end(), [](int n) { return n > 0; }) > 24);
}

TEST_CASE("the nearest of several is found and numbered as added", "[shape]") {
  ShapeSet set;
  CHECK(set.add(Box{Vec3(-1, -1, -9), Vec3(1, 1, -8)}) == 0);
  CHECK(set.add(Plane{Vec3(0, 0, -20), Vec3(0, 0, 1)}) == 1);
  CHECK(set.add(Sphere{Vec3(0, 0, -4), 1}) == 2);
  Hit hit;
  REQUIRE(set.intersect({Vec3(0, 0, 0), -Vec3::UnitZ()}, hit));
  CHECK(hit.object == 2);
  REQUIRE(set.intersect({Vec3(0, 0, -6), -Vec3::UnitZ()}, hit));
  CHECK(hit.object == 0);
  REQUIRE(set.intersect({Vec3(3, 0, 0), -Vec3::UnitZ()}, hit));
  CHECK(hit.object == 1);
  CHECK_FALSE(ShapeSet().intersect({Vec3(3, 0, 0), -Vec3::UnitZ()}, hit));
}
