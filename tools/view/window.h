#pragma once
// Interactive windows that show scenes or transfer.

#include <view/frame.h>
#include <wavelet/base/image.h>

#include <renderer/transfer/relight.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::view {

/// What a window does without a user.
struct WindowScript {
  std::optional<int> frames; ///< close after this many
  double turn = 0;           ///< degrees that the camera moves right, or transfer's light rotates
  int reloads = 0;           ///< reloads of watched files to wait for before the first frame counts
  bool screenshot = false;   ///< of the last frame
};

struct WindowInput {
  std::string scene;                  ///< a scene file or a set of trees
  std::string second;                 ///< right pane: trees of the first material, or a scene
  std::vector<std::string> materials; ///< further .haar files that can be chosen
  int width = 1024;                   ///< of the window, pixels
  int height = 768;
  std::optional<int> level;
  PunctualLight punctual;
  bool environment = false; ///< light by the environment; needs a probe here or in the scene
  std::string probe;        ///< image or trees in place of the scene's light, or empty
  int light_level = 10;     ///< an environment is stored as 2^light_level squares a side
  float tolerance = default_tolerance;
  double exposure = 0; ///< stops
  bool watch = false;  ///< reload files when they are rewritten
  bool panel = true;   ///< visible at the start
  WindowScript script;
};

struct WindowReport {
  std::string renderer; ///< GL_RENDERER
  int width = 0;        ///< of the window, pixels
  int height = 0;
  int frames = 0;          ///< in which a picture was drawn
  double milliseconds = 0; ///< median of the left picture
  double accesses = 0;     ///< to textures, mean per pixel of the last left picture
  int reloads = 0;         ///< successful
  int failed_reloads = 0;
  Image screenshot; ///< if asked for
};

/// Shows a window until the user closes it or the script ends.
/// @param note receives messages about reloaded files
/// @throws Error as Screen and Panes, or Error(Output) in a build without windows
WindowReport show_window(const WindowInput& input,
                         const std::function<void(const std::string&)>& note);

/// The view of a transfer.
struct TransferState {
  std::array<float, 3> rotate = {0, 0, 0}; ///< yaw, pitch, roll of the light, degrees
  int level = 0;                           ///< as TransferDrawer::draw()
  float exposure = 0;                      ///< stops

  bool operator==(const TransferState&) const = default;
};

struct TransferWindowInput {
  TransferState state; ///< at the start
  bool panel = true;   ///< visible at the start
  WindowScript script; ///< ignores `reloads`
};

/// Likewise for transfer; milliseconds of the report include rotating the light.
/// @param scene of the transfer, with the light that is shown
/// @throws Error as Screen, TransferLight and TransferDrawer, or Error(Output) in a build without
///         windows
WindowReport show_transfer(const renderer::Transfer& transfer,
                           const renderer::SceneDescription& scene,
                           const TransferWindowInput& input);

} // namespace haarlight::view
