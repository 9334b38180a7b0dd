#include <view/window_side.h>

namespace haarlight::view {

using renderer::CameraDescription;
using renderer::SceneDescription;

namespace {

bool same(const CameraDescription& a, const CameraDescription& b) {
  return a.projection == b.projection && a.from == b.from && a.to == b.to && a.up == b.up &&
         a.fov == b.fov && a.height == b.height;
}

bool same(const Lamp& a, const Lamp& b) {
  return a.at_point == b.at_point && a.place == b.place && (a.irradiance == b.irradiance).all();
}

bool same_size(const Look& a, const Look& b) { return a.width == b.width && a.height == b.height; }

bool same(const Look& a, const Look& b) {
  return same(a.camera, b.camera) && same(a.lamp, b.lamp) && a.light == b.light &&
         a.to_world == b.to_world && a.background == b.background && a.tolerance == b.tolerance &&
         a.level == b.level && same_size(a, b);
}

SceneDescription describe(const Subject& subject) {
  SceneDescription scene = describe_view(subject.scene);
  if (!subject.material.empty() && !scene.materials.empty()) {
    scene.materials[0] = {};
    scene.materials[0].name = "trees";
    scene.materials[0].haar = subject.material;
  }
  return scene;
}

std::vector<std::string> files_of(const Subject& subject, const SceneDescription& scene) {
  std::vector<std::string> files = {subject.scene};
  for (const renderer::MaterialDescription& material : scene.materials)
    for (const std::string& path : {material.haar, material.brdf})
      if (!path.empty())
        files.push_back(path);
  return files;
}

ViewScene open(SceneDescription scene, bool copied) {
  FileCopies copies;
  try {
    for (renderer::MaterialDescription& material : scene.materials)
      for (std::string* path : {&material.haar, &material.brdf})
        if (copied)
          copies.take(*path);
    return ViewScene(std::move(scene));
  } catch (const Error& error) {
    throw copies.told_of_originals(error);
  }
}

} // namespace

Side::Side(Subject subject, bool watched)
    : m_subject(std::move(subject)), m_watched(watched), m_watch({}) {
  load();
}

void Side::load() {
  SceneDescription description = describe(m_subject);
  FileWatch watch(files_of(m_subject, description)); // before they are read: later changes are seen
  const ViewScene scene = open(description, m_watched);
  auto drawer = std::make_unique<FrameDrawer>(scene, 1, 1);
  m_description = std::move(description);
  m_watch = std::move(watch);
  m_levels = scene.levels();
  m_drawer = std::move(drawer);
  m_drawn.reset();
}

bool Side::draw(const Look& look, bool always) {
  if (m_drawn && same(*m_drawn, look) && !always)
    return false;
  if (!m_drawn || !same_size(*m_drawn, look))
    m_drawer->resize(look.width, look.height);
  m_drawer->set_camera(look.camera);
  m_drawer->set_lamp(look.lamp);
  if (look.light != nullptr && (!m_drawn || m_drawn->light != look.light))
    m_drawer->set_light(*look.light);
  m_drawer->turn_light(look.to_world);
  m_drawer->show_background(look.background);
  m_drawer->set_tolerance(look.tolerance);
  const bool environment = look.light != nullptr;
  m_milliseconds = m_drawer->draw(environment ? Lighting::Environment : Lighting::Lamp, look.level);
  m_drawn = look;
  m_counted = false;
  return true;
}

void Side::count_accesses() {
  if (!m_counted && m_drawn)
    m_accesses = m_drawer->read().accesses;
  m_counted = true;
}

} // namespace haarlight::view
