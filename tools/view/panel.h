#pragma once
// The controls of the window.

#include <string>
#include <vector>

namespace haarlight::view {

/// Set by controls, mouse and keyboard.
struct Settings {
  int material = 0;       ///< index into PanelContents::materials; 0 is the given file
  int second = 0;         ///< likewise of the right pane; 0 is no second pane
  int light = 0;          ///< index into PanelContents::lights; 0 is the punctual light
  float exposure = 0;     ///< stops
  int level = -1;         ///< automatic_level or 0 … the deepest tree's
  float light_yaw = 0;    ///< degrees about world +y, right-handed, relative to the given light
  float light_pitch = 0;  ///< degrees about world +x, applied before the yaw
  int min_pixel_size = 1; ///< window pixels along a side of one drawn pixel, at least
  float tolerance = 0;    ///< as ViewState; no effect on a punctual light
  bool panel = true;      ///< visible
};

struct PaneStatistics {
  std::string name;
  double accesses = 0; ///< to textures that hold trees, mean per pixel
  double milliseconds = 0;
  std::size_t texture_bytes = 0;
};

/// The choices and results that the panel shows.
struct PanelContents {
  std::vector<std::string> materials;
  std::vector<std::string> others; ///< of the right pane
  std::vector<std::string> lights;
  int levels = 0;
  std::vector<PaneStatistics> panes;
  std::string message; ///< about watched files, or empty
  bool is_error = false;
};

/// Declares the panel to Dear ImGui, between Screen::begin() and end().
void show_panel(const PanelContents& contents, Settings& settings);

/// Begins an ImGui window at the panel's place.
void begin_panel(int flags);

/// Writes the names below the panes, side by side. @param width of the window, pixels
void show_pane_names(const std::vector<PaneStatistics>& panes, int width);

} // namespace haarlight::view
