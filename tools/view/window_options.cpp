#include <view/window_options.h>

#include <support/arguments.h>

#include <wavelet/file/output_file.h>

namespace haarlight::view {

void declare_window(tool::Tool& app, WindowOptions& options) {
  WindowInput& input = options.input;
  app.optional_input(
      input.against, "--against", "FILE.haar|SCENE.json",
      "In the window: shown beside the first; trees take the place of the scene's first "
      "material");
  app.optional_inputs(
      input.materials, "--material", "FILE.haar",
      "In the window: trees to choose from, before those in the folder of the first file");
  app.flag(input.watch, "--watch", "In the window: read files again when they are rewritten");
  app.flag(input.bare, "--no-panel", "The window begins without its controls; Tab shows them");
  app.optional_output(options.screenshot, "--screenshot", "OUT.png",
                      "Save the window as it is at the last of --frames");
  app.value(input.script.frames, "--frames", "Close the window after so many frames", 1, 1000000);
  app.value(
      input.script.turn, "--turn",
      "Degrees that the camera goes to the right, or transfer's light turns, over all --frames",
      -36000, 36000);
  app.value(input.script.reloads, "--reloads",
            "With --watch: files are to be rewritten so many times before --frames are counted", 0,
            1000);
}

void check_window(const tool::Tool& app, const WindowOptions& options, bool window) {
  for (const char* name : {"--against", "--material", "--watch", "--no-panel", "--screenshot",
                           "--frames", "--turn", "--reloads"})
    if (!window && app.given(name))
      throw tool::UsageError(
          std::string(name).append(": is of the window, not of --frame or --export"));
  for (const char* name : {"--repeat", "--compare", "--reference"})
    if (window && app.given(name))
      throw tool::UsageError(std::string(name).append(": is of --frame and --export"));
  for (const char* name : {"--screenshot", "--turn", "--reloads"})
    if (app.given(name) && !options.input.script.frames)
      throw tool::UsageError(std::string(name).append(": needs --frames as well"));
  if (options.input.script.reloads > 0 && !options.input.watch)
    throw tool::UsageError("--reloads: needs --watch as well");
  if (options.screenshot.empty())
    return;
  if (options.screenshot != standard_output && !tool::has_extension(options.screenshot, ".png"))
    throw tool::UsageError("--screenshot: \"" + options.screenshot + "\" does not end in .png");
  const OutputFile trial(options.screenshot);
}

} // namespace haarlight::view
