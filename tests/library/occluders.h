#pragma once
// One object of every kind that may hide a light from a point.

#include "temporary_folder.h"

#include <renderer/light/light.h>
#include <renderer/shapes/shapes.h>

#include <probe/rgbe.h>
#include <probe/synth.h>

#include <string>
#include <vector>

namespace haarlight::renderer {

/// Any light: only its frame matters, which is turned against the world.
inline const Light& turned_light() {
  static const TemporaryFolder folder;
  static const Light light = [] {
    LightDescription description;
    description.probe = folder.file("light.hdr");
    description.mapping = "angular";
    description.rotate = 40;
    probe::write_rgbe(description.probe,
                      probe::draw_angular(*probe::make_scene(probe::SceneKind::Studio), 16));
    return Light(description, probe::Lookup::Nearest);
  }();
  return light;
}

/// A small sphere at the origin that is shaded at its top, and another object.
struct Pair {
  std::string name;
  Shape shape;
  AffineMap transform = {};
};

inline std::vector<Pair> pairs() {
  AffineMap squashed = scaling({1, 0.3, 0.6}).then(euler_rotation({20, 30, 40}));
  squashed.offset = {-1, 1, 0.5};
  return {{"sphere", Sphere{Vec3(0.6F, 0.7F, -0.4F), 0.5F}},
          {"far sphere", Sphere{Vec3(20, 30, -10), 1}},
          {"plane below", Plane{Vec3(0, -0.2F, 0), Vec3(0.1F, 1, 0)}},
          {"plane above", Plane{Vec3(0, 2, 0), Vec3(0.3F, 1, -0.2F)}},
          {"disk", Disk{Vec3(0.3F, 1, 0.2F), Vec3(1, 2, -3), 0.7F}},
          {"box", Box{Vec3(0.3F, 0.4F, -1), Vec3(1, 0.9F, 1)}},
          {"floor", Box{Vec3(-5, -0.3F, -5), Vec3(5, -0.2F, 5)}},
          {"cylinder", Cylinder{Vec3(-0.5F, 0.5F, 0), Vec3(0.3F, 1.1F, 0.4F), 0.2F}},
          {"cone", Cone{Vec3(0.1F, 0.8F, 0.2F), Vec3(0.5F, 1.2F, -0.4F), 0.6F}},
          {"torus", Torus{Vec3(0.1F, 0.9F, -0.2F), Vec3(0.3F, 1, 0.5F), 0.6F, 0.15F}},
          {"squashed sphere", Sphere{}, squashed}};
}

inline Hit top_of_sphere() {
  Hit hit;
  hit.position = Vec3(0, 0.1F, 0);
  hit.normal = Vec3::UnitY();
  hit.object = 0;
  return hit;
}

inline ShapeSet both(const Pair& pair) {
  ShapeSet set;
  set.add(Sphere{Vec3::Zero(), 0.1F});
  set.add(pair.shape, pair.transform);
  return set;
}

} // namespace haarlight::renderer
