#include <view/panes.h>

#include <renderer/light/light.h>
#include <wavelet/base/error.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <sys/stat.h>

namespace haarlight::view {

using renderer::CameraDescription;
using renderer::SceneDescription;

namespace {

SceneDescription describe_choice(const SceneChoice& choice) {
  SceneDescription scene = describe_view(choice.scene);
  if (!choice.material.empty() && !scene.materials.empty()) {
    scene.materials[0] = {};
    scene.materials[0].name = "trees";
    scene.materials[0].haar = choice.material;
  }
  return scene;
}

std::vector<std::string> files_of(const SceneChoice& choice, const SceneDescription& scene) {
  std::vector<std::string> files = {choice.scene};
  for (const renderer::MaterialDescription& material : scene.materials)
    for (const std::string& path : {material.haar, material.brdf})
      if (!path.empty())
        files.push_back(path);
  return files;
}

template <class Part>
void reload_if_changed(Part& part, std::vector<ReloadMessage>& messages) {
  if (!part.changed())
    return;
  try {
    part.reload();
    messages.push_back({part.name() + " was reloaded", false});
  } catch (const Error& error) {
    messages.push_back({std::string(error.what()) + "; the previous version is kept", true});
  }
}

/// A camera that shows the film's full width in a viewport that is narrower than the film.
CameraDescription widened(CameraDescription camera, const SceneDescription& film,
                          const Viewport& viewport) {
  const double factor =
      std::max(1.0, 1.0 * film.width * viewport.height / film.height / viewport.width);
  const double half = camera.fov * std::numbers::pi / 360;
  camera.fov = std::atan(factor * std::tan(half)) * 360 / std::numbers::pi;
  camera.height *= factor;
  return camera;
}

void open_pane(std::unique_ptr<Pane>& pane, const SceneChoice& choice) {
  if (choice == SceneChoice())
    pane.reset();
  else if (!pane || pane->choice() != choice)
    pane = std::make_unique<Pane>(choice);
}

} // namespace

FileWatch::FileWatch(std::vector<std::string> paths)
    : m_paths(std::move(paths)), m_reported(stamp()), m_latest(m_reported) {}

bool FileWatch::changed() {
  const Stamp now = stamp();
  const bool settled = now == m_latest;
  m_latest = now;
  if (!settled || now == m_reported)
    return false;
  m_reported = now;
  return true;
}

FileWatch::Stamp FileWatch::stamp() const {
  Stamp result;
  for (const std::string& path : m_paths) {
    struct stat status = {};
    if (::stat(path.c_str(), &status) != 0)
      status = {};
    result.insert(result.end(), {static_cast<std::int64_t>(status.st_ino), status.st_size,
                                 status.st_mtim.tv_sec, status.st_mtim.tv_nsec});
  }
  return result;
}

EnvironmentLight::EnvironmentLight(renderer::LightDescription description, int level)
    : m_description(std::move(description)), m_level(level), m_watch({file_of(m_description)}) {
  m_description.table.clear();
  reload();
}

void EnvironmentLight::reload() {
  const renderer::Light light(m_description, probe::Lookup::Nearest);
  m_packed = std::make_shared<const PackedLight>(pack_light(light.map(1 << m_level)));
  m_to_world = light_to_world(light);
}

Pane::Pane(SceneChoice choice) : m_choice(std::move(choice)), m_watch({}) { reload(); }

void Pane::reload() {
  SceneDescription description = describe_choice(m_choice);
  FileWatch watch(files_of(m_choice, description)); // before reading, to detect later changes
  const ViewScene scene(description);
  auto drawer = std::make_unique<SceneDrawer>(scene);
  m_description = std::move(description);
  m_watch = std::move(watch);
  m_levels = scene.levels();
  m_drawer = std::move(drawer);
  m_drawn.reset();
}

bool Pane::draw(const ViewState& state, bool always) {
  if (m_drawn == state && !always)
    return false;
  m_milliseconds = m_drawer->draw(state);
  m_drawn = state;
  m_counted = false;
  return true;
}

double Pane::milliseconds_per_pixel() const {
  return m_drawn ? m_milliseconds / (1.0 * m_drawn->width * m_drawn->height) : 0;
}

PaneStatistics Pane::statistics(bool count) {
  if (count && !m_counted && m_drawn)
    m_accesses = m_drawer->read().accesses;
  m_counted = m_counted || count;
  return {name(), m_accesses, m_milliseconds, m_drawer->texture_bytes()};
}

Panes::Panes(const WindowInput& input)
    : m_light_level(input.light_level),
      m_left(std::make_unique<Pane>(SceneChoice{input.scene, {}})),
      m_choices(find_choices(input, scene().light)) {}

void Panes::choose(const Settings& settings) {
  const auto index = [](int choice) { return static_cast<std::size_t>(choice); };
  open_pane(m_left, m_choices.materials[index(settings.material)]);
  open_pane(m_right, m_choices.others[index(settings.second)]);
  if (settings.light == m_chosen_light)
    return;
  m_light = settings.light == 0 ? nullptr
                                : std::make_unique<EnvironmentLight>(
                                      m_choices.lights[index(settings.light)], m_light_level);
  m_chosen_light = settings.light;
}

std::vector<Pane*> Panes::panes() const {
  std::vector<Pane*> all = {m_left.get()};
  if (m_right)
    all.push_back(m_right.get());
  return all;
}

int Panes::levels() const {
  if (m_light)
    return m_light->packed()->levels;
  return std::max(m_left->levels(), m_right ? m_right->levels() : 0);
}

std::vector<PaneStatistics> Panes::statistics(bool count) const {
  std::vector<PaneStatistics> result;
  for (Pane* const pane : panes())
    result.push_back(pane->statistics(count));
  return result;
}

std::vector<ReloadMessage> Panes::reload_changed() {
  std::vector<ReloadMessage> messages;
  for (Pane* const pane : panes())
    reload_if_changed(*pane, messages);
  if (m_light)
    reload_if_changed(*m_light, messages);
  return messages;
}

bool Panes::draw(const Viewport& window, const ViewState& state, int pixel_size, float exposure,
                 bool always) {
  const std::vector<Pane*> all = panes();
  const int width = std::max(window.width / static_cast<int>(all.size()), 1);
  bool drawn = false;
  int x = 0;
  for (Pane* const pane : all) {
    const Viewport viewport = {x, 0, width, window.height};
    ViewState own = state;
    own.camera = widened(state.camera, scene(), viewport);
    if (m_light) {
      own.environment = m_light->packed();
      own.to_world *= m_light->to_world();
      own.background = m_light->background();
    }
    own.width = std::max(viewport.width / pixel_size, 1);
    own.height = std::max(viewport.height / pixel_size, 1);
    drawn = pane->draw(own, always) || drawn;
    pane->show(viewport, static_cast<double>(exposure));
    x += width;
  }
  return drawn;
}

} // namespace haarlight::view
