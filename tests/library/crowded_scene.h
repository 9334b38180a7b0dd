#pragma once
// A sphere with occluders of every kind around it.

#include "sampler_fixture.h"

namespace haarlight::renderer {

/// A shaded sphere among a shape of every kind.
inline SceneDescription crowded(const std::string& material) {
  SceneDescription description = fixture().scene(material, "studio");
  const auto add = [&](const Shape& shape) { description.objects.push_back({shape, {}, 0}); };
  add(Plane{Vec3(1.6F, 0, 0), Vec3(-1, 0.3F, 0)});
  add(Sphere{Vec3(0.3F, 1.9F, 0.5F), 0.5F});
  add(Box{Vec3(-1, 1.4F, 0.8F), Vec3(1, 1.6F, 1.4F)});
  add(Cylinder{Vec3(-0.6F, 0, -1), Vec3(-0.6F, 3, 0.5F), 0.1F});
  add(Torus{Vec3(0, 1.6F, 0), Vec3(0.2F, 1, 0.1F), 0.5F, 0.1F});
  return description;
}

inline bool visible(const LoadedScene& scene, const Hit& hit, const Vec3& w) {
  return !scene.shapes().occluded(leave(hit, scene.light().to_world(w)));
}

} // namespace haarlight::renderer
