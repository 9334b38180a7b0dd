// haarview: shows stored trees, reconstructed in a fragment shader.
#include <render/film_output.h>
#include <support/program.h>
#include <support/words.h>

#include <view/comparison.h>
#include <view/egl_context.h>
#include <view/view_options.h>
#include <view/window_run.h>

#include <image/image_exr.h>
#include <image/png.h>

#include <renderer/light.h>
#include <wavelet/input_file.h>
#include <wavelet/parallel.h>
#include <wavelet/tree_set.h>

#include <cstdlib>

using namespace haarlight;
using namespace haarlight::view;

namespace {

/// The scene as the command line has it: film, and light.
renderer::SceneDescription description_of(const ViewScene& scene, const Options& options) {
  renderer::SceneDescription result = scene.description();
  if (!options.size.empty())
    tool::set_film_size(options.size, result);
  if (!options.probe.empty()) {
    const bool trees = wavelet::begins_as_tree_set(InputFile(options.probe));
    result.light.probe = trees ? "" : options.probe;
    result.light.haar = trees ? options.probe : "";
  }
  if (options.environment && result.light.probe.empty() && result.light.haar.empty())
    throw tool::UsageError("--environment: there is no scene that names a light; --probe does");
  return result;
}

void set_light(const renderer::LightDescription& description, int level, FrameDrawer& drawer) {
  const renderer::Light light(description, probe::Lookup::Nearest);
  drawer.set_light(pack_light(light.map(1 << level)));
  Eigen::Matrix3f to_world;
  for (int axis = 0; axis < 3; ++axis)
    to_world.col(axis) = light.to_world(Vec3::Unit(axis));
  drawer.turn_light(to_world);
  drawer.show_background(description.background);
}

void write(const Options& options, const image::Picture& picture) {
  if (tool::has_extension(options.frame, ".png"))
    image::write_png(options.frame, picture, {options.exposure, image::ToneMap::Filmic});
  else
    image::write_exr(options.frame, picture);
}

int view_scene(const tool::Tool& app, const Options& options) {
  check(app, options);
  if (app.given("--threads"))
    setenv("LP_NUM_THREADS", std::to_string(thread_count()).c_str(), 1); // llvmpipe's own
  if (options.frame.empty())
    return view_in_window(app, options);
  const Lamp lamp = lamp_of(options);
  const Lighting lighting = lighting_of(options);
  const ViewScene scene(options.input);
  const renderer::SceneDescription film = description_of(scene, options);
  const std::vector<float> reference = reference_of(scene, film, options);
  const EglContext context;
  FrameDrawer drawer(scene, film.width, film.height);
  drawer.set_lamp(lamp);
  if (lighting == Lighting::Environment)
    set_light(film.light, options.light_level, drawer);
  drawer.set_tolerance(options.tolerance);
  const int level = options.level.value_or(automatic_level);
  drawer.draw(lighting, level); // compiles the shaders as well
  const DrawnFrame frame = drawer.read();
  image::Picture picture(film.width, film.height);
  picture.rgb = frame.rgb;
  write(options, picture);
  const Drawing drawing = {drawer, lighting, options.repeat};
  tool::Report report;
  report.add("renderer", context.renderer())
      .add("width", film.width, "px")
      .add("height", film.height, "px")
      .add("level", options.level ? std::to_string(level) : std::string("as needed"))
      .add("trees", scene.trees().size())
      .add("texture_bytes", drawer.texture_bytes())
      .add("accesses_per_pixel", frame.accesses)
      .add("ms_per_frame", drawing.time(level), "ms");
  if (!reference.empty())
    add_comparison(drawing, level, finest_level(scene, options), reference, report);
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
