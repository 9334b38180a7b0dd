#pragma once
// The light in a window: a lamp, or what lies around.

#include <view/packed_light.h>
#include <view/window_watch.h>

#include <renderer/scene/scene.h>

#include <memory>
#include <string>

namespace haarlight::view {

/// An image or a light's trees as a scene would name it.
renderer::LightDescription light_of_file(const std::string& path);

/// The file that it names, or nothing.
inline const std::string& file_of(const renderer::LightDescription& light) {
  return light.haar.empty() ? light.probe : light.haar;
}

/// A light that is read again when its file is rewritten.
class WindowLight {
public:
  /// @param level   it is kept as 2^level squares a side
  /// @param watched its file is copied before it is used
  /// @throws Error(Input) as renderer::Light
  WindowLight(renderer::LightDescription description, int level, bool watched);

  std::string name() const;
  const std::shared_ptr<const PackedLight>& squares() const { return m_squares; }
  /// From its frame to the world's.
  const Eigen::Matrix3f& to_world() const { return m_to_world; }
  /// Whether it is to be seen where there is no object.
  bool background() const { return m_description.background; }
  int level() const { return m_squares->levels; }

  /// Whether its file has been rewritten, by FileWatch::changed().
  bool changed() { return m_watch.changed(); }
  /// Reads it again; if that fails it stays as it was. @throws as the constructor
  void reload();

private:
  renderer::LightDescription m_description;
  int m_level;
  bool m_watched;
  FileWatch m_watch;
  std::shared_ptr<const PackedLight> m_squares;
  Eigen::Matrix3f m_to_world;
};

} // namespace haarlight::view
