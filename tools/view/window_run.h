#pragma once
// haarview's window as its command line asks for it.

#include <view/view_options.h>

namespace haarlight::view {

/// Shows the window, then writes the screenshot and reports. @throws as show_window()
int view_in_window(const tool::Tool& app, const Options& options);

/// Writes the screenshot and reports what a window showed.
/// @return the exit code @throws Error(Output)
int report_window(const tool::Tool& app, const Options& options, const WindowReport& shown);

} // namespace haarlight::view
