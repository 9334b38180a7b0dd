#include <view/window_light.h>

#include <renderer/light/light.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/tree_set.h>

namespace haarlight::view {

using renderer::Light;
using renderer::LightDescription;

namespace {

Light open(LightDescription description, bool copied) {
  FileCopies copies;
  try {
    if (copied) {
      copies.take(description.haar);
      copies.take(description.probe);
    }
    return {description, probe::Lookup::Nearest};
  } catch (const Error& error) {
    throw copies.told_of_originals(error);
  }
}

} // namespace

LightDescription light_of_file(const std::string& path) {
  LightDescription light;
  (wavelet::begins_as_tree_set(InputFile(path)) ? light.haar : light.probe) = path;
  return light;
}

WindowLight::WindowLight(LightDescription description, int level, bool watched)
    : m_description(std::move(description)), m_level(level), m_watched(watched),
      m_watch({file_of(m_description)}) {
  m_description.table.clear();
  reload();
}

std::string WindowLight::name() const { return base_name(file_of(m_description)); }

void WindowLight::reload() {
  const Light light = open(m_description, m_watched);
  m_squares = std::make_shared<const PackedLight>(pack_light(light.map(1 << m_level)));
  for (int axis = 0; axis < 3; ++axis)
    m_to_world.col(axis) = light.to_world(Vec3::Unit(axis));
}

} // namespace haarlight::view
