#include <view/view_options.h>

#include <support/arguments.h>

#include <wavelet/file/output_file.h>

namespace haarlight::view {
namespace {

void declare_lamp(tool::Tool& app, Options& options) {
  constexpr double most = 1e6;
  app.values(options.direction, "--light-direction", "Direction towards the lamp, any length", 3,
             -most, most);
  app.values(options.position, "--light-position", "Place of the lamp, in place of a direction", 3,
             -most, most);
  app.values(options.irradiance, "--irradiance",
             "What a surface facing the lamp receives (from a --light-position at distance 1), "
             "W m⁻², R,G,B",
             3, 0, most);
}

void declare_environment(tool::Tool& app, Options& options) {
  app.flag(options.environment, "--environment",
           "Light by the scene's probe in place of a lamp: the integral of reflectance and light, "
           "square by square");
  app.optional_input(
      options.probe, "--probe", "FILE",
      "Probe image, or light's trees, in place of the scene's; implies --environment");
  app.value(options.light_level, "--light-level",
            "Of --environment: the light is kept as 2^N squares a side; without, 10, and 8 for an "
            "--export alone",
            2, 11);
  app.value(options.tolerance, "--tolerance",
            "Of --environment: squares are split while each leaves more than this share of its "
            "pixel in doubt, by estimate",
            1e-4F, 1);
}

} // namespace

void declare(tool::Tool& app, Options& options) {
  app.input(options.input, "SCENE.json|FILE.haar",
            "Scene of spheres and planes, or a set of a BRDF's trees by θ_r, shown on a sphere, or "
            "transfer that haarrelight built with --vary light");
  app.optional_output(options.frame, "--frame", "OUT.exr|.png",
                      "Picture to write, in place of a window to show; a .png is tone-mapped");
  app.optional_output(
      options.page, "--export", "PAGE.html",
      "Page to write, in place of a window, that shows the same in a browser with WebGL 2, all "
      "in one file; with --compare, its #check compares as well");
  app.text(options.size, "--size", "WxH", "Size in pixels, in place of the scene's or 256x256");
  app.value(options.level, "--level",
            "Level of the trees that all pixels take, 13 being every tree's finest; without, each "
            "takes the level it needs. Of --environment: the finest level of the light's squares",
            0, 13);
  declare_lamp(app, options);
  declare_environment(app, options);
  app.value(options.exposure, "--exposure", "Stops that a .png is brightened by", -30, 30);
  app.value(options.repeat, "--repeat", "Frames timed, the median of which is reported", 1, 10000);
  app.flag(options.compare, "--compare",
           "Report the relative root mean square error of the frame, and of frames at every level, "
           "against the same trees evaluated on the CPU at full level (of --environment: against "
           "haarrender's product-integral, without the background)");
  app.optional_input(
      options.reference, "--reference", "REF.exr",
      "Picture to --compare with in place of that; of --environment without its background");
  declare_window(app, options.window);
  declare_transfer(app, options.transfer);
  app.offer_json();
}

void check(const tool::Tool& app, const Options& options) {
  if (!options.frame.empty())
    tool::check_picture_path(options.frame, "--frame");
  if (app.given("--light-position") && app.given("--light-direction"))
    throw tool::UsageError("--light-direction and --light-position: only one can be given");
  const bool lamp = lighting_of(options) == Lighting::Lamp;
  for (const char* other : {"--light-direction", "--light-position", "--irradiance"})
    if (!lamp && app.given(other))
      throw tool::UsageError(std::string(other).append(": is of a lamp, not of --environment"));
  for (const char* other : {"--light-level", "--tolerance"})
    if (lamp && app.given(other))
      throw tool::UsageError(std::string(other).append(": is of --environment"));
  check_window(app, options.window, shows_window(options));
  for (const std::string& output : {options.frame, options.page})
    if (!output.empty())
      const OutputFile trial(output);
}

Lamp lamp_of(const Options& options) {
  const auto vec = [](const std::vector<double>& v) { return Eigen::Vector3d(v.data()); };
  Lamp lamp;
  lamp.at_point = !options.position.empty();
  lamp.place = vec(lamp.at_point ? options.position : options.direction).cast<float>();
  lamp.irradiance = vec(options.irradiance).cast<float>().array();
  if (!lamp.at_point && lamp.place.stableNorm() < 1e-18F)
    throw tool::UsageError("--light-direction: has no length; any other direction will do");
  return lamp;
}

} // namespace haarlight::view
