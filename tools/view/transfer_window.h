#pragma once
// A window on transfer, in which the mouse turns the light.

#include <view/window.h>

#include <renderer/transfer/relight.h>

#include <array>

namespace haarlight::view {

/// What is seen of transfer.
struct TransferLook {
  std::array<float, 3> rotate = {0, 0, 0}; ///< yaw, pitch, roll of the light, degrees
  int level = 0;                           ///< as TransferDrawer::draw() has it
  float exposure = 0;                      ///< stops

  bool operator==(const TransferLook&) const = default;
};

struct TransferWindowInput {
  TransferLook look;   ///< at first
  bool bare = false;   ///< begins without controls
  WindowScript script; ///< which turns the light, and waits for no file
};

/// Shows a window until the user closes it or the script ends. The report's milliseconds are those
/// of turning the light and drawing.
/// @param scene the transfer's, with the light that is shown
/// @throws Error as Screen, TransferLight and TransferDrawer, or Error(Output) where this was built
///         without windows
WindowReport show_transfer(const renderer::Transfer& transfer,
                           const renderer::SceneDescription& scene,
                           const TransferWindowInput& input);

} // namespace haarlight::view
