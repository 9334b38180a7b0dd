#pragma once
// The part of haarview's command line that is about its window.

#include <support/tool.h>
#include <view/window.h>

#include <string>

namespace haarlight::view {

struct WindowOptions {
  WindowInput input; ///< what other options say as well is left as it is
  std::string screenshot;
};

void declare_window(tool::Tool& app, WindowOptions& options);

/// Refuses contradictions and an unwritable output before any work is done.
/// @param window whether a window is to be shown at all
/// @throws UsageError, Error(Output)
void check_window(const tool::Tool& app, const WindowOptions& options, bool window);

} // namespace haarlight::view
