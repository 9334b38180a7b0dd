#pragma once
// A window's pixels as a picture.

#include <image/image.h>
#include <view/gl_objects.h>

namespace haarlight::view {

/// What was drawn to the window and is not shown yet, as linear values of 8-bit codes.
image::Picture read_window(const Area& area);

} // namespace haarlight::view
