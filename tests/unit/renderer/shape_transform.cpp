// Transforms, on their own and applied to shapes.

#include "renderer_shape_reference.h"

#include <renderer/shapes/shapes.h>

#include <catch2/catch.hpp>

#include <vector>

using namespace haarlight;
using namespace haarlight::renderer;
using Eigen::Vector3d;

namespace {

/// The same map by another library's hand.
Eigen::Affine3d eigen_map() {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.prerotate(Eigen::AngleAxisd(0.7, Vector3d(1, 2, -0.5).normalized()));
  map.prescale(Vector3d(1.5, 0.6, -0.9));
  map.pretranslate(Vector3d(0.3, -0.8, 0.5));
  return map;
}

AffineMap our_map() {
  return rotation({1, 2, -0.5}, 0.7 * 180 / M_PI)
      .then(scaling({1.5, 0.6, -0.9}))
      .then(translation({0.3, -0.8, 0.5}));
}

} // namespace

TEST_CASE("steps compose in the order written", "[transform]") {
  const Eigen::Affine3d truth = eigen_map();
  const AffineMap ours = our_map();
  CHECK((ours.linear - truth.linear()).norm() < 1e-14);
  CHECK((ours.offset - truth.translation()).norm() < 1e-14);
  const AffineMap round_trip = ours.then(ours.inverse());
  CHECK((round_trip.linear - Eigen::Matrix3d::Identity()).norm() < 1e-14);
  CHECK(round_trip.offset.norm() < 1e-14);
}

TEST_CASE("rotations are right-handed", "[transform]") {
  CHECK((rotation({0, 0, 2}, 90).point({1, 0, 0}) - Vector3d(0, 1, 0)).norm() < 1e-15);
  CHECK((rotation({0, 1, 0}, 90).point({0, 0, 1}) - Vector3d(1, 0, 0)).norm() < 1e-15);
  // x first: +y goes to +z, then about y to +x, then about z to +y.
  CHECK((euler_rotation({90, 90, 90}).point({0, 1, 0}) - Vector3d(0, 1, 0)).norm() < 1e-15);
  CHECK((euler_rotation({0, 90, 90}).point({0, 0, 1}) - Vector3d(0, 1, 0)).norm() < 1e-15);
}

TEST_CASE("maps that flatten or leave the range of numbers are not usable", "[transform]") {
  CHECK(our_map().usable());
  CHECK_FALSE(scaling({1, 0, 1}).usable());
  CHECK_FALSE(scaling({1e19, 1, 1}).usable());
  CHECK_FALSE(scaling({1e-19, 1, 1}).usable());
  CHECK_FALSE(translation({0, NAN, 0}).usable());
  AffineMap flat;
  flat.linear << 1, 2, 3, 2, 4, 6, 0, 0, 1;
  CHECK_FALSE(flat.usable());
}

TEST_CASE("transformed shapes are hit where the shapes are hit by the ray mapped back",
          "[transform]") {
  const std::vector<Shape> shapes = {Sphere{Vec3(0.2F, 0.1F, 0), 1},
                                     Plane{Vec3(0, -0.2F, 0), Vec3(0.1F, 1, 0.3F)},
                                     Disk{Vec3(0, 0, 0), Vec3(1, 1, 0), 1},
                                     Box{},
                                     Cylinder{Vec3(0, -0.7F, 0), Vec3(0.2F, 0.9F, 0), 0.7F},
                                     Cone{},
                                     Torus{Vec3(0, 0, 0), Vec3(0, 1, 1), 1, 0.35F}};
  const Eigen::Affine3d back = eigen_map().inverse();
  reference::Random random(6);
  for (std::size_t which = 0; which < shapes.size(); ++which) {
    INFO("shape " << which);
    ShapeSet set;
    set.add(shapes[which], our_map());
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 origin = random.point(4);
      const Ray ray{origin, (random.point(1) - origin).normalized(), 30};
      const Vector3d local = back.linear() * ray.direction.cast<double>();
      const auto truth = reference::follow(shapes[which], back * ray.origin.cast<double>(),
                                           local.normalized(), 30 * local.norm());
      if (truth.answer == reference::Answer::Unclear)
        continue;
      Hit hit;
      REQUIRE(set.intersect(ray, hit) == (truth.answer == reference::Answer::Hit));
      if (truth.answer != reference::Answer::Hit)
        continue;
      ++hits;
      REQUIRE(hit.t == Approx(truth.t / local.norm()).epsilon(3e-6).margin(3e-6));
      if (which == 2)
        continue; // a disk's distance has no gradient on it
      const Vector3d p = back * hit.position.cast<double>();
      const Vector3d fine = reference::normal(shapes[which], p, 1e-5);
      if ((fine - reference::normal(shapes[which], p, 1e-3)).norm() > 0.1)
        continue;
      const Vector3d normal = (back.linear().transpose() * fine).normalized();
      REQUIRE((hit.normal.cast<double>() - normal).norm() < 2e-3);
    }
    CHECK(hits > 100);
  }
}

TEST_CASE("a scaled sphere is an ellipsoid", "[transform]") {
  ShapeSet set;
  set.add(Sphere{}, scaling({1, 2, 0.5}));
  Hit hit;
  REQUIRE(set.intersect({Vec3(0, 5, 0), -Vec3::UnitY()}, hit));
  CHECK(hit.t == Approx(3));
  reference::Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 origin = random.point(4);
    if (!set.intersect({origin, (random.point(0.4F) - origin).normalized()}, hit))
      continue;
    const Vec3 p = hit.position;
    const float x = p.x();
    const float y = p.y() / 2;
    const float z = p.z() / 0.5F;
    REQUIRE(x * x + y * y + z * z == Approx(1).epsilon(1e-5));
    REQUIRE((hit.normal - Vec3(x, y / 2, z / 0.5F).normalized()).norm() < 1e-4F);
  }
}

TEST_CASE("rotated, mirrored and uniformly scaled spheres stay spheres", "[transform]") {
  ShapeSet plain;
  ShapeSet turned;
  plain.add(Sphere{Vec3(0, 3, 0), 2});
  turned.add(Sphere{Vec3(1, 0, 0), 1},
             rotation({0, 0, 1}, 90).then(scaling({-2, 2, 2})).then(translation({0, 1, 0})));
  reference::Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Ray ray{random.point(6), random.direction()};
    Hit a;
    Hit b;
    REQUIRE(plain.intersect(ray, a) == turned.intersect(ray, b));
    REQUIRE((a.position - b.position).norm() < 2e-6F);
    REQUIRE((a.normal - b.normal).norm() < 2e-6F);
  }
}
