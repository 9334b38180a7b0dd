#pragma once
// A window's pixels as a picture.

#include <view/gl_objects.h>
#include <wavelet/base/image.h>

namespace haarlight::view {

/// What was drawn to the window and is not shown yet, as linear values of 8-bit codes.
Image read_window(const Area& area);

} // namespace haarlight::view
