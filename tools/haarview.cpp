// haarview: shows stored trees, reconstructed in a fragment shader.
#include <support/arguments.h>
#include <support/tool.h>

#include <view/commands.h>

#include <renderer/transfer/relight.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/output_file.h>
#include <wavelet/file/tree_set.h>

#include <cstdlib>
#include <initializer_list>

using namespace haarlight;
using view::Options;

namespace {

void declare_light(tool::Tool& app, Options& options) {
  constexpr double limit = 1e6;
  app.values(options.direction, "--light-direction",
             "Direction towards a directional light, any length", 3, -limit, limit);
  app.values(options.position, "--light-position", "Position of a point light instead", 3, -limit,
             limit);
  app.values(options.irradiance, "--irradiance",
             "R,G,B of a surface that faces the light (a point light: at distance 1), W m⁻²", 3, 0,
             limit);
  app.flag(options.environment, "--environment",
           "Light by the scene's probe instead: integrate reflectance times light over the light's "
           "squares");
  app.optional_input(options.probe, "--probe", "FILE",
                     "Probe image or trees of a light that replaces the scene's; implies "
                     "--environment");
  app.alias("--light", "--probe");
  app.alias("--against", "--beside");
  app.alias("--tolerance", "--split-threshold");
  app.value(options.light_level, "--light-level",
            "With --environment: store the light as 2^N squares a side [10; 8 for --html alone]", 2,
            11);
  app.value(
      options.tolerance, "--split-threshold",
      "With --environment: split a square of the light while its estimated error exceeds this "
      "fraction of the pixel's value",
      1e-4F, 1);
}

void declare_comparison(tool::Tool& app, Options& options) {
  app.value(options.repeat, "--repeat", "Number of timed frames; the median is reported", 1, 10000);
  app.flag(options.compare, "--compare",
           "Report the relative root mean square error of the frame, and of frames at every level, "
           "against the same trees evaluated on the CPU at full resolution (with --environment: by "
           "haarrender's product-integral, without the background)");
  app.optional_input(options.reference, "--reference", "REF.exr",
                     "Picture to compare with instead; with --environment without its background");
}

void declare_window(tool::Tool& app, Options& options) {
  app.optional_input(options.second, "--beside", "FILE.haar|SCENE.json",
                     "Window: show this in a second pane; trees replace those of the scene's first "
                     "material");
  app.optional_inputs(options.materials, "--material", "FILE.haar",
                      "Window: more trees to choose from, besides those in the input's folder");
  app.flag(options.watch, "--watch", "Window: reload files when they are rewritten");
  app.flag(options.no_panel, "--no-panel", "Window: start without the controls; Tab shows them");
  app.optional_output(options.screenshot, "--screenshot", "OUT.png",
                      "Window: save its last frame; needs --frames");
  app.value(options.script.frames, "--frames", "Window: close after this number of frames", 1,
            1000000);
  app.value(
      options.script.turn, "--turn",
      "Window: degrees that the camera orbits to the right, or that transfer's light rotates, "
      "over all --frames",
      -36000, 36000);
  app.value(options.script.reloads, "--reloads",
            "With --watch: number of reloads to wait for before --frames are counted", 0, 1000);
}

void declare_transfer(tool::Tool& app, Options& options) {
  app.values(options.rotate, "--rotate",
             "Transfer: rotate the light by yaw, pitch, roll, degrees, as haarrelight apply", 3,
             -1e6, 1e6);
  app.optional_input(options.transfer_scene, "--scene", "SCENE.json",
                     "Transfer: the scene it was built from [the file of that name beside it]");
}

void declare(tool::Tool& app, Options& options) {
  app.input(
      options.input, "SCENE.json|FILE.haar",
      "Scene of spheres and planes; or a BRDF set by θ_r, shown on a sphere; or transfer that "
      "haarrelight built with --vary light");
  app.optional_output(options.frame, "--image", "OUT.exr|.png",
                      "Write a picture instead of showing a window; a .png is tone-mapped");
  app.optional_output(
      options.page, "--html", "PAGE.html",
      "Write an interactive page for browsers with WebGL 2 instead, in a single file; with "
      "--compare its #check compares as well");
  app.alias("--export", "--html");
  app.alias("--frame", "--image");
  app.text(options.size, "--size", "WxH", "Size in pixels [the scene's, or 256x256]");
  app.value(options.level, "--level",
            "Level of the trees for all pixels, 13 for full resolution [the level that each pixel "
            "needs]; with --environment: the finest level of the light's squares",
            0, 13);
  declare_light(app, options);
  app.value(options.exposure, "--exposure", "Exposure of a .png and of the window, stops", -30, 30);
  declare_comparison(app, options);
  declare_window(app, options);
  declare_transfer(app, options);
  app.offer_json();
}

/// @throws UsageError if any of the options was given
void refuse(const tool::Tool& app, std::initializer_list<const char*> names,
            const std::string& reason) {
  for (const char* name : names)
    if (app.given(name))
      throw tool::UsageError(std::string(name) + ": " + reason);
}

void check_window(const tool::Tool& app, const Options& options) {
  if (!options.shows_window())
    refuse(app,
           {"--beside", "--material", "--watch", "--no-panel", "--screenshot", "--frames", "--turn",
            "--reloads"},
           "needs a window, without --image and --html");
  else
    refuse(app, {"--repeat", "--compare", "--reference"}, "needs --image or --html");
  if (!options.script.frames)
    refuse(app, {"--screenshot", "--turn", "--reloads"}, "needs --frames");
  if (options.script.reloads > 0 && !options.watch)
    throw tool::UsageError("--reloads: needs --watch");
  if (!options.screenshot.empty() && options.screenshot != standard_output &&
      !tool::has_extension(options.screenshot, ".png"))
    throw tool::UsageError("--screenshot: \"" + options.screenshot + "\" does not end in .png");
}

/// Reports contradictions and unwritable outputs before any work. @throws UsageError, Error(Output)
void check(const tool::Tool& app, const Options& options) {
  if (!options.frame.empty())
    tool::check_picture_path(options.frame, "--image");
  if (app.given("--light-position") && app.given("--light-direction"))
    throw tool::UsageError("--light-direction and --light-position exclude each other");
  if (options.uses_environment())
    refuse(app, {"--light-direction", "--light-position", "--irradiance"},
           "has no effect with --environment");
  else
    refuse(app, {"--light-level", "--split-threshold"}, "needs --environment");
  check_window(app, options);
  for (const std::string& output : {options.frame, options.page, options.screenshot})
    if (!output.empty())
      const OutputFile trial(output);
}

bool is_transfer(const std::string& path) {
  return wavelet::file_form(path) &&
         renderer::is_transfer(wavelet::open_tree_set(path, wavelet::Check::WhenUsed).info());
}

int view_input(const tool::Tool& app, Options& options) {
  check(app, options);
  options.script.screenshot = !options.screenshot.empty();
  if (app.given("--threads")) // llvmpipe has a setting of its own
    setenv("LP_NUM_THREADS", std::to_string(thread_count()).c_str(), 1);
  if (!is_transfer(options.input)) {
    refuse(app, {"--rotate", "--scene"},
           "applies to transfer, which haarrelight build makes with --vary light");
    return view_scene(app, options);
  }
  refuse(app,
         {"--size", "--light-direction", "--light-position", "--irradiance", "--environment",
          "--light-level", "--split-threshold", "--html", "--beside", "--material", "--watch",
          "--reloads"},
         "does not apply to transfer; --rotate and --probe change its light");
  return view_transfer(app, options);
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command("haarview",
                    "Shows stored trees with OpenGL in a window, a picture or a page; a fragment "
                    "shader reconstructs them at the level that each pixel needs.",
                    declare, view_input));
}
