#pragma once
// The content of a window: one or two pictures side by side, their light, and the files that the
// user can choose.

#include <view/frame.h>
#include <view/panel.h>
#include <view/window.h>

#include <renderer/scene/scene.h>
#include <wavelet/file/input_file.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::view {

/// Detects that files were rewritten, by their sizes, times and inodes.
class FileWatch {
public:
  explicit FileWatch(std::vector<std::string> paths);

  /// Call every few tenths of a second.
  /// @return true once for each change, as soon as the files are the same in two calls; a file that
  ///         disappears is a change as well
  bool changed();

private:
  using Stamp = std::vector<std::int64_t>;
  Stamp stamp() const;

  std::vector<std::string> m_paths;
  Stamp m_reported; ///< at the last reported change
  Stamp m_latest;   ///< at the last call
};

/// A scene, optionally with other trees for its first material.
struct SceneChoice {
  std::string scene;    ///< a scene file, or a BRDF set shown on a sphere; empty for no scene
  std::string material; ///< .haar file of the first material, or empty
  bool operator==(const SceneChoice&) const = default;

  std::string name() const { return base_name(material.empty() ? scene : material); }
};

/// The files that the user can choose.
struct Choices {
  std::vector<SceneChoice> materials; ///< of the left pane; the first is the given file
  std::vector<SceneChoice> others;    ///< of the right pane; the first is none
  /// The first is none: the punctual light. Then the given light, if any.
  std::vector<renderer::LightDescription> lights;
};

/// The given files, and those in the same folders that can be shown: θ_r-only BRDF sets, trees of
/// lights and .hdr images.
/// @param light the scene's own
/// @throws Error(Input) if a given file cannot be read
Choices find_choices(const WindowInput& input, const renderer::LightDescription& light);

/// A panel that shows the choices.
PanelContents panel_contents(const Choices& choices);

/// The file of a light, or an empty string.
inline const std::string& file_of(const renderer::LightDescription& light) {
  return light.haar.empty() ? light.probe : light.haar;
}

/// A distant light that can be read again when its file is rewritten.
class EnvironmentLight {
public:
  /// @param level it is stored as 2^level squares a side
  /// @throws Error(Input) as renderer::Light
  EnvironmentLight(renderer::LightDescription description, int level);

  std::string name() const { return base_name(file_of(m_description)); }
  const std::shared_ptr<const PackedLight>& packed() const { return m_packed; }
  /// From the light's frame to the world.
  const Eigen::Matrix3f& to_world() const { return m_to_world; }
  /// Whether it is visible where no object is.
  bool background() const { return m_description.background; }

  bool changed() { return m_watch.changed(); }
  /// On an error it stays as it was. @throws as the constructor
  void reload();

private:
  renderer::LightDescription m_description;
  int m_level;
  FileWatch m_watch;
  std::shared_ptr<const PackedLight> m_packed;
  Eigen::Matrix3f m_to_world;
};

/// The picture of one scene, drawn only when its view changes. Needs one current GL context for its
/// whole life.
class Pane {
public:
  /// @throws as ViewScene and SceneDrawer
  explicit Pane(SceneChoice choice);

  std::string name() const { return m_choice.name(); }
  const SceneChoice& choice() const { return m_choice; }
  const renderer::SceneDescription& description() const { return m_description; }
  int levels() const { return m_levels; }

  bool changed() { return m_watch.changed(); }
  /// On an error everything stays as it was. @throws as the constructor
  void reload();

  /// Draws if the view changed since the last call, or always. @return whether it was drawn
  bool draw(const ViewState& state, bool always);
  void show(const Viewport& viewport, double exposure) const {
    m_drawer->show(0, viewport, exposure);
  }
  /// Milliseconds per pixel of the last picture.
  double milliseconds_per_pixel() const;
  /// @param count read back the last picture and count its accesses; else those counted last
  PaneStatistics statistics(bool count);

private:
  SceneChoice m_choice;
  FileWatch m_watch;
  renderer::SceneDescription m_description;
  int m_levels = 0;
  std::unique_ptr<SceneDrawer> m_drawer;
  std::optional<ViewState> m_drawn;
  double m_milliseconds = 0;
  double m_accesses = 0;
  bool m_counted = false;
};

/// The result of reading a rewritten file.
struct ReloadMessage {
  std::string text;
  bool is_error = false; ///< the file could not be read; the previous version is kept
};

/// The panes and their light. Needs one current GL context for its whole life.
class Panes {
public:
  /// Opens the left pane. @throws as Pane and find_choices()
  explicit Panes(const WindowInput& input);

  const Choices& choices() const { return m_choices; }
  /// Opens the files that the settings choose. @throws as Pane and EnvironmentLight
  void choose(const Settings& settings);

  /// The scene of the left pane, which defines camera and film.
  const renderer::SceneDescription& scene() const { return m_left->description(); }
  /// Of the deepest tree, or of the finest squares of the environment.
  int levels() const;
  /// @param count as Pane::statistics()
  std::vector<PaneStatistics> statistics(bool count) const;
  double milliseconds_per_pixel() const { return m_left->milliseconds_per_pixel(); }

  /// Reads rewritten files; call every few tenths of a second.
  std::vector<ReloadMessage> reload_changed();

  /// Draws the panes whose view changed, or all, and shows them side by side.
  /// @param state      without environment and size
  /// @param pixel_size window pixels along a side of one drawn pixel
  /// @param exposure   stops
  /// @return whether anything was drawn
  bool draw(const Viewport& window, const ViewState& state, int pixel_size, float exposure,
            bool always);

private:
  std::vector<Pane*> panes() const;

  int m_light_level;
  std::unique_ptr<Pane> m_left;
  std::unique_ptr<Pane> m_right;
  std::unique_ptr<EnvironmentLight> m_light;
  int m_chosen_light = 0;
  Choices m_choices;
};

} // namespace haarlight::view
