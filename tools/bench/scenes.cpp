#include <bench/scenes.h>

#include <bench/plan.h>

#include <renderer/scene/scene.h>
#include <wavelet/base/error.h>

namespace haarlight::bench {

using namespace renderer;

namespace {

bool built_in(const std::string& word) { return word == "sphere" || word == "spheres"; }

void add(const Shape& shape, SceneDescription& scene) {
  ObjectDescription object;
  object.shape = shape;
  scene.objects.push_back(object);
}

SceneDescription one_sphere() {
  SceneDescription scene;
  scene.camera.projection = CameraProjection::Orthographic;
  scene.camera.from = Vec3(0, 0, 6);
  scene.camera.height = 2;
  add(Sphere(), scene);
  return scene;
}

SceneDescription three_spheres() {
  SceneDescription scene;
  scene.camera.from = Vec3(0, 4, 6);
  scene.camera.to = Vec3(0, -0.3F, 0);
  scene.camera.fov = 32;
  add(Plane{Vec3(0, -1, 0), Vec3::UnitY()}, scene);
  add(Sphere{Vec3(0, 0, -0.6F), 1}, scene);
  add(Sphere{Vec3(-1.2F, -0.4F, 0.7F), 0.6F}, scene);
  add(Sphere{Vec3(1.1F, -0.5F, 0.8F), 0.5F}, scene);
  return scene;
}

} // namespace

std::string scene_name(const std::string& word) { return built_in(word) ? word : stem_of(word); }

SceneDescription scene_of(const std::string& word) {
  if (!built_in(word)) {
    SceneDescription scene = load_scene(word);
    if (scene.materials.empty())
      throw_input_error(word, "has no material that the BRDF could take the place of");
    return scene;
  }
  SceneDescription scene = word == "sphere" ? one_sphere() : three_spheres();
  scene.path = word;
  scene.light.background = false;
  scene.materials.resize(1);
  scene.materials.front().name = "measured";
  return scene;
}

} // namespace haarlight::bench
