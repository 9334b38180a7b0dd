#pragma once
// What the user does with the mouse.

namespace haarlight::view {

/// What mouse and keyboard asked for since the last turn, controls left aside.
struct Gestures {
  double orbit_x = 0; ///< dragged with the left button, pixels to the right
  double orbit_y = 0; ///< and down
  double light_x = 0; ///< with the right button
  double light_y = 0;
  double wheel = 0;    ///< notches away from the user
  bool moving = false; ///< a button is down, on a control as well, or the wheel turns
  bool reset = false;  ///< R
  bool panel = false;  ///< Tab
};

/// What Dear ImGui has seen of the mouse, in a turn that has begun.
Gestures mouse_gestures();

} // namespace haarlight::view
