#pragma once
// A window on the screen with OpenGL 3.3, Dear ImGui controls, mouse and keyboard.

#include <view/gl.h>
#include <wavelet/base/image.h>

#include <memory>
#include <string>

namespace haarlight::view {

/// Mouse and keyboard input of one iteration of the window loop, except input to controls.
struct UserInput {
  double orbit_x = 0; ///< drag with the left button, pixels to the right
  double orbit_y = 0; ///< and down
  double light_x = 0; ///< drag with the right button
  double light_y = 0;
  double wheel = 0;          ///< notches away from the user
  bool moving = false;       ///< a button is down, on a control as well, or the wheel turns
  bool reset = false;        ///< R was pressed
  bool toggle_panel = false; ///< Tab was pressed
};

/// Its context is current to the thread that made it. One per process at a time. An iteration of
/// the window loop is: begin(); declare controls to Dear ImGui and draw pictures to framebuffer 0,
/// in any order; end().
class Screen {
public:
  /// @throws Error(Output) that names what is missing, if there is no display or no OpenGL 3.3
  Screen(int width, int height, const std::string& title);
  ~Screen();
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// False after the user closed the window or pressed Escape.
  bool is_open() const;

  /// @param timeout seconds to wait for an event; 0 does not wait
  UserInput begin(double timeout);
  /// Draws the controls and displays the frame.
  /// @param screenshot receives the frame as linear values of its 8-bit codes, if not null
  void end(Image* screenshot);

  /// The whole window, pixels.
  Viewport viewport() const;
  /// Whether end() waits for the display's refresh.
  void set_vsync(bool on);

private:
  struct Parts;
  std::unique_ptr<Parts> m_parts;
};

} // namespace haarlight::view
