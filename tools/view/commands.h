#pragma once
// haarview's options, and its two commands: show a scene, and show transfer.

#include <support/tool.h>
#include <view/frame.h>
#include <view/window.h>

#include <optional>
#include <string>
#include <vector>

namespace haarlight::view {

struct Options {
  std::string input;
  std::string frame;
  std::string page;
  std::string size;
  std::optional<int> level;
  std::vector<double> direction = {0.4, 0.6, 0.7};
  std::vector<double> position;
  std::vector<double> irradiance = {3, 3, 3};
  bool environment = false;
  std::string probe;
  std::optional<int> light_level;
  float tolerance = default_tolerance;
  double exposure = 0;
  int repeat = 3;
  bool compare = false;
  std::string reference;

  // Of the window.
  std::string second;
  std::vector<std::string> materials;
  bool watch = false;
  bool no_panel = false;
  std::string screenshot;
  WindowScript script;

  // Of transfer, as haarrelight apply.
  std::string transfer_scene;
  std::vector<double> rotate = {0, 0, 0};

  bool shows_window() const { return frame.empty() && page.empty(); }
  bool uses_environment() const { return environment || !probe.empty(); }
};

/// @throws UsageError, Error @return the exit code
int view_scene(const tool::Tool& app, const Options& options);
int view_transfer(const tool::Tool& app, const Options& options);

/// Writes the screenshot and prints the report of a window.
/// @return the exit code @throws Error(Output)
int report_window(const tool::Tool& app, const Options& options, const WindowReport& report);

} // namespace haarlight::view
