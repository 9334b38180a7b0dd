#pragma once
// From what the user does to what a window's pictures show.

#include <view/window.h>
#include <view/window_gestures.h>
#include <view/window_orbit.h>
#include <view/window_panel.h>
#include <view/window_side.h>

namespace haarlight::view {

/// What is shown at first.
Settings settings_of(const WindowInput& input);

/// Lets mouse and keyboard move the camera, the light and the panel.
/// @param start where the camera goes when it is reset
void steer(const Gestures& gestures, const renderer::CameraDescription& start, Orbit& orbit,
           Settings& settings);

/// What is drawn, but for the picture's size and the light around.
/// @param hurried time counts more than looks
Look look_of(const Settings& settings, const Orbit& orbit, const Lamp& lamp, bool hurried);

} // namespace haarlight::view
