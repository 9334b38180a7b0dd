#pragma once
// haarview of transfer.

#include <view/view_options.h>

#include <string>

namespace haarlight::view {

/// Whether a file is a set of trees that haarrelight build made.
/// @throws Error(Input) if it cannot be read
bool is_transfer(const std::string& path);

/// Draws a transfer's picture, or shows it in a window, and reports.
/// @return the exit code @throws UsageError, Error
int view_transfer(const tool::Tool& app, const Options& options);

} // namespace haarlight::view
