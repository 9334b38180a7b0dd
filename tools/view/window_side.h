#pragma once
// One of the pictures in a window.

#include <view/frame.h>
#include <view/window_watch.h>

#include <wavelet/file/input_file.h>

#include <memory>
#include <optional>
#include <string>

namespace haarlight::view {

/// What is shown.
struct Subject {
  std::string scene;    ///< a scene file, or a BRDF's set on a sphere
  std::string material; ///< trees in place of the scene's first material, or empty
  bool operator==(const Subject&) const = default;

  /// Of the file that tells this subject from another.
  std::string name() const { return base_name(material.empty() ? scene : material); }
};

/// All that a picture of a subject depends on.
struct Look {
  renderer::CameraDescription camera;
  Lamp lamp;
  std::shared_ptr<const PackedLight> light;               ///< in place of the lamp, if not null
  Eigen::Matrix3f to_world = Eigen::Matrix3f::Identity(); ///< from the light's frame
  bool background = true; ///< that light is seen where there is no object
  float tolerance = environment_tolerance;
  int level = automatic_level;
  int width = 1; ///< pixels
  int height = 1;
};

/// A subject's picture, drawn anew when it has to be. Needs the current context all its life.
class Side {
public:
  /// @param watched files are copied before they are used, so that they may be rewritten in place
  /// @throws as ViewScene and FrameDrawer
  Side(Subject subject, bool watched);

  const Subject& subject() const { return m_subject; }
  const renderer::SceneDescription& description() const { return m_description; }
  int levels() const { return m_levels; }
  std::size_t texture_bytes() const { return m_drawer->texture_bytes(); }

  /// Whether its files have been rewritten, by FileWatch::changed().
  bool changed() { return m_watch.changed(); }
  /// Reads its files again; if that fails all stays as it was. @throws as the constructor
  void reload() { load(); }

  /// Draws if anything differs from the last time, or always.
  /// @return whether it was drawn
  bool draw(const Look& look, bool always);
  /// Of the picture drawn last.
  double milliseconds() const { return m_milliseconds; }
  double milliseconds_per_pixel() const {
    return m_drawn ? m_milliseconds / (1.0 * m_drawn->width * m_drawn->height) : 0;
  }
  /// Of textures that hold trees, on average over pixels that have any, in the picture that was
  /// counted last.
  double accesses() const { return m_accesses; }
  /// Counts those of the picture drawn last, which is read back for this, if it has not been.
  void count_accesses();

  void show(const Area& area, double exposure) const { m_drawer->show(0, area, exposure); }

private:
  void load();

  Subject m_subject;
  bool m_watched;
  FileWatch m_watch;
  renderer::SceneDescription m_description;
  int m_levels = 0;
  std::unique_ptr<FrameDrawer> m_drawer;
  std::optional<Look> m_drawn;
  double m_milliseconds = 0;
  double m_accesses = 0;
  bool m_counted = false;
};

} // namespace haarlight::view
