#pragma once
// What a window shows: pictures side by side and their light.

#include <view/window_choices.h>
#include <view/window_light.h>
#include <view/window_panel.h>
#include <view/window_side.h>

#include <memory>
#include <string>
#include <vector>

namespace haarlight::view {

/// What became of a file that was rewritten.
struct News {
  std::string text;
  bool bad = false; ///< it could not be read, and the version before is kept
};

/// Opened as they are chosen. Need the current context all their life.
class Exhibits {
public:
  /// Opens the left picture. @throws as Side and choices_of()
  explicit Exhibits(const WindowInput& input);

  const WindowChoices& choices() const { return m_choices; }
  /// Opens what the settings choose unless it is open. @throws as Side and WindowLight
  void choose(const Settings& settings);

  /// The left picture's scene: its camera and film.
  const renderer::SceneDescription& scene() const { return m_left->description(); }
  /// Of the deepest tree, or of the finest squares of light.
  int levels() const;
  /// @param count whether accesses are counted, which takes time
  std::vector<SideFigures> figures(bool count);
  /// What the left picture took at last, ms, by pixel.
  double milliseconds_per_pixel() const { return m_left->milliseconds_per_pixel(); }

  /// Reads files again that have been rewritten; to be asked some tenths of a second apart.
  std::vector<News> read_again();

  /// Draws what has to be drawn anew, or all, and shows it side by side.
  /// @param look       of all but what this knows: the light around and the pictures' size
  /// @param coarseness of the window's pixels, along a side of one of a picture's
  /// @param exposure   stops
  /// @return whether anything had to be drawn
  bool draw(const Area& window, const Look& look, int coarseness, float exposure, bool always);

private:
  Look completed(Look look, const Area& area, int coarseness) const;
  std::vector<Side*> sides() const;
  void exchange(std::unique_ptr<Side>& side, const Subject& subject) const;

  bool m_watched;
  int m_light_level;
  std::unique_ptr<Side> m_left;
  std::unique_ptr<Side> m_right;
  std::unique_ptr<WindowLight> m_light;
  int m_chosen_light = 0;
  WindowChoices m_choices;
};

} // namespace haarlight::view
