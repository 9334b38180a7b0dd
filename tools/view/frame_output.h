#pragma once
// Frames as files.

#include <view/view_options.h>

namespace haarlight::view {

/// Writes what --frame asks for. @throws Error(Output)
void write_frame(const Options& options, const DrawnFrame& frame, int width, int height);

} // namespace haarlight::view
