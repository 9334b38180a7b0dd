#pragma once
// The controls in a window.

#include <string>
#include <utility>
#include <vector>

namespace haarlight::view {

/// What the user sets by controls, and keyboard and mouse move.
struct Settings {
  int material = 0;     ///< of the choices; 0 is what was given
  int against = 0;      ///< the same for the other side, 0 being none
  int light = 0;        ///< 0 is the lamp
  float exposure = 0;   ///< stops
  int level = -1;       ///< automatic_level or 0 … the deepest tree's
  float light_turn = 0; ///< degrees about world +y, right-handed, from where it was given
  float light_tilt = 0; ///< degrees about world +x, before it is turned
  int coarseness = 1;   ///< at least, of the window's pixels along a side of one of a picture's
  float tolerance = 0;  ///< share of a pixel that may be in doubt; without effect on the lamp
  bool panel = true;
};

struct SideFigures {
  std::string name;
  double accesses = 0; ///< of textures of trees, per fragment
  double milliseconds = 0;
  std::size_t texture_bytes = 0;
};

/// What the panel tells, and what there is to choose from.
struct PanelContents {
  std::vector<std::string> materials;
  std::vector<std::string> others;
  std::vector<std::string> lights;
  int levels = 0;
  std::vector<SideFigures> sides;
  std::string news; ///< of the files that are watched, or empty
  bool bad_news = false;
};

/// Declares the panel to Dear ImGui, between Screen::begin() and end().
void show_panel(const PanelContents& contents, Settings& settings);

/// Writes names over the pictures, side by side.
/// @param width of the window, pixels
void show_names(const std::vector<SideFigures>& sides, int width);

} // namespace haarlight::view
