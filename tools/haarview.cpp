// haarview: shows stored trees, reconstructed in a fragment shader.
#include <render/film_output.h>
#include <support/program.h>
#include <support/words.h>

#include <view/cpu_frame.h>
#include <view/egl_context.h>
#include <view/frame.h>
#include <view/window_options.h>

#include <image/image_exr.h>
#include <image/png.h>

#include <wavelet/output_file.h>
#include <wavelet/parallel.h>

#include <algorithm>
#include <cstdlib>

using namespace haarlight;
using namespace haarlight::view;

namespace {

struct Options {
  std::string input;
  std::string frame;
  std::string size;
  std::optional<int> level;
  std::vector<double> direction = {0.4, 0.6, 0.7};
  std::vector<double> position;
  std::vector<double> irradiance = {3, 3, 3};
  double exposure = 0;
  int repeat = 3;
  bool compare = false;
  WindowOptions window;
};

void declare(tool::Tool& app, Options& options) {
  constexpr double most = 1e6;
  app.input(options.input, "SCENE.json|FILE.haar",
            "Scene of spheres and planes, or a set of a BRDF's trees by θ_r, shown on a sphere");
  app.text(options.frame, "--frame", "OUT.exr|.png",
           "Picture to write, in place of a window to show; a .png is tone-mapped");
  app.text(options.size, "--size", "WxH", "Size in pixels, in place of the scene's or 256x256");
  app.value(options.level, "--level",
            "Level of the trees that all pixels take, 13 being every tree's finest; without, each "
            "takes the level it needs",
            0, 13);
  app.values(options.direction, "--light-direction", "Direction towards the light, any length", 3,
             -most, most);
  app.values(options.position, "--light-position", "Place of the light, in place of a direction", 3,
             -most, most);
  app.values(options.irradiance, "--irradiance",
             "What a surface facing the light receives (from a --light-position at distance 1), "
             "W m⁻², R,G,B",
             3, 0, most);
  app.value(options.exposure, "--exposure", "Stops that a .png is brightened by", -30, 30);
  app.value(options.repeat, "--repeat", "Frames timed, the median of which is reported", 1, 10000);
  app.flag(options.compare, "--compare",
           "Report the relative root mean square error of the frame, and of frames at every level, "
           "against the same trees evaluated on the CPU at full level");
  declare_window(app, options.window);
  app.offer_json();
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

/// Refuses contradictions and an unwritable output before any work is done.
void check(const tool::Tool& app, const Options& options) {
  tool::check_picture_path(options.frame, "--frame");
  if (app.given("--light-position") && app.given("--light-direction"))
    throw tool::UsageError("--light-direction and --light-position: only one can be given");
  check_window(app, options.window, options.frame.empty());
  for (const char* name : {"--repeat", "--compare"})
    if (options.frame.empty() && app.given(name))
      throw tool::UsageError(std::string(name).append(": is of --frame"));
  if (!options.frame.empty())
    const OutputFile trial(options.frame);
}

int view_in_window(const tool::Tool& app, Options options) {
  WindowInput& input = options.window.input;
  renderer::SceneDescription film;
  if (!options.size.empty()) {
    tool::set_film_size(options.size, film);
    input.width = film.width;
    input.height = film.height;
  }
  input.scene = options.input;
  input.level = options.level;
  input.lamp = lamp_of(options);
  input.exposure = options.exposure;
  return run_window(app, options.window);
}

void write(const Options& options, const image::Picture& picture) {
  if (tool::has_extension(options.frame, ".png"))
    image::write_png(options.frame, picture, {options.exposure, image::ToneMap::Filmic});
  else
    image::write_exr(options.frame, picture);
}

/// Median time of a frame, ms.
double time_frames(const FrameDrawer& drawer, int level, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i)
    times.push_back(drawer.draw(level));
  std::nth_element(times.begin(), times.begin() + count / 2, times.end());
  return times[static_cast<std::size_t>(count / 2)];
}

void add_comparison(tool::Report& report, const DrawnFrame& frame, const FrameDrawer& drawer,
                    const std::vector<float>& reference, int levels, int repeat) {
  report.add("relative_rms", relative_rms(frame.rgb, reference));
  for (int level = 0; level <= levels; ++level) {
    const double ms = time_frames(drawer, level, repeat);
    const DrawnFrame coarse = drawer.read();
    report.row("levels")
        .add("level", level)
        .add("relative_rms", relative_rms(coarse.rgb, reference))
        .add("accesses", coarse.accesses)
        .add("ms_per_frame", ms);
  }
}

void limit_threads(const tool::Tool& app) {
  if (app.given("--threads"))
    setenv("LP_NUM_THREADS", std::to_string(thread_count()).c_str(), 1); // llvmpipe's own
}

int view_scene(const tool::Tool& app, const Options& options) {
  check(app, options);
  limit_threads(app);
  if (options.frame.empty())
    return view_in_window(app, options);
  const Lamp lamp = lamp_of(options);
  const ViewScene scene(options.input);
  renderer::SceneDescription film = scene.description();
  if (!options.size.empty())
    tool::set_film_size(options.size, film);
  const EglContext context;
  const FrameDrawer drawer(scene, film.width, film.height);
  drawer.set_lamp(lamp);
  const int level = options.level.value_or(automatic_level);
  drawer.draw(level); // compiles the shaders as well
  image::Picture picture(film.width, film.height);
  const DrawnFrame frame = drawer.read();
  picture.rgb = frame.rgb;
  write(options, picture);
  tool::Report report;
  report.add("renderer", context.renderer())
      .add("width", film.width, "px")
      .add("height", film.height, "px")
      .add("level", options.level ? std::to_string(level) : std::string("as needed"))
      .add("trees", scene.trees().size())
      .add("texture_bytes", drawer.texture_bytes())
      .add("accesses_per_pixel", frame.accesses)
      .add("ms_per_frame", time_frames(drawer, level, options.repeat), "ms");
  if (options.compare)
    add_comparison(report, frame, drawer, cpu_frame(scene, lamp, film.width, film.height),
                   scene.levels(), options.repeat);
  app.print(report);
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv, "haarview",
      "Shows trees by GL, in a window or a picture: a fragment shader reconstructs "
      "them at the level each pixel needs.",
      declare, view_scene);
}
