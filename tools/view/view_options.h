#pragma once
// The command line of haarview.

#include <support/tool.h>
#include <view/frame.h>
#include <view/transfer_options.h>
#include <view/window_options.h>

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
  float tolerance = environment_tolerance;
  double exposure = 0;
  int repeat = 3;
  bool compare = false;
  std::string reference;
  WindowOptions window;
  TransferOptions transfer;
};

void declare(tool::Tool& app, Options& options);

/// Refuses contradictions and an unwritable output before any work is done. @throws UsageError,
/// Error(Output)
void check(const tool::Tool& app, const Options& options);

/// @throws UsageError if its direction has no length
Lamp lamp_of(const Options& options);

/// Squares along a side of the light as 2^N: fewer in a page, which would be large.
inline int light_level_of(const Options& options) {
  return options.light_level.value_or(options.frame.empty() ? 8 : 10);
}

/// Unless a file is to be written.
inline bool shows_window(const Options& options) {
  return options.frame.empty() && options.page.empty();
}

inline Lighting lighting_of(const Options& options) {
  return options.environment || !options.probe.empty() ? Lighting::Environment : Lighting::Lamp;
}

} // namespace haarlight::view
