#pragma once
// The viewer's window.

#include <view/frame.h>
#include <wavelet/base/image.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::view {

/// What a window does by itself, in place of the user.
struct WindowScript {
  std::optional<int> frames; ///< then it closes
  double turn = 0;           ///< degrees that the camera goes to the right over these frames
  int reloads = 0;           ///< changes of watched files to wait for before the first of them
  bool screenshot = false;   ///< of the last frame
};

struct WindowInput {
  std::string scene;                  ///< or a set of trees
  std::string against;                ///< shown beside: trees of its first material, or a scene
  std::vector<std::string> materials; ///< further trees to choose from
  int width = 1024;                   ///< of the window, pixels
  int height = 768;
  std::optional<int> level;
  Lamp lamp;
  Lighting lighting = Lighting::Lamp; ///< Environment only if there is a probe or the scene has one
  std::string probe;                  ///< image or light's trees in place of the scene's; or empty
  int light_level = 10;               ///< a light is kept as 2^light_level squares a side
  float tolerance = environment_tolerance;
  double exposure = 0; ///< stops
  bool watch = false;  ///< files are read again when they are rewritten
  bool bare = false;   ///< begins without controls
  WindowScript script;
};

struct WindowReport {
  std::string renderer; ///< what drew, in the driver's words
  int width = 0;        ///< of the window, pixels
  int height = 0;
  int frames = 0;          ///< in which anything was drawn anew
  double milliseconds = 0; ///< the median of what the left picture took
  double accesses = 0;     ///< of textures per pixel, of the left picture at last
  int reloads = 0;         ///< that went well
  int refusals = 0;        ///< that did not
  Image picture;           ///< if asked for
};

/// Shows a window until the user closes it or the script ends.
/// @param note told of files that were read again or could not be
/// @throws Error as Side and Screen, or Error(Output) where this was built without windows
WindowReport show_window(const WindowInput& input,
                         const std::function<void(const std::string&)>& note);

} // namespace haarlight::view
