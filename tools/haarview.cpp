// haarview: shows stored trees, reconstructed in a fragment shader.
#include <render/film_output.h>
#include <support/tool.h>

#include <view/comparison.h>
#include <view/egl_context.h>
#include <view/frame_output.h>
#include <view/page.h>
#include <view/transfer_frame.h>
#include <view/view_options.h>
#include <view/window_run.h>

#include <renderer/light/light.h>
#include <wavelet/base/parallel.h>
#include <wavelet/file/file_hash.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/output_file.h>
#include <wavelet/file/provenance.h>
#include <wavelet/file/tree_set.h>

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

/// What is shown, ready to be drawn or to become a page.
PageOptions shown_of(const ViewScene& scene, const Options& options) {
  PageOptions shown;
  shown.film = description_of(scene, options);
  shown.lamp = lamp_of(options);
  shown.level = options.level.value_or(automatic_level);
  shown.tolerance = options.tolerance;
  shown.exposure = options.exposure;
  shown.reference = reference_of(scene, shown.film, options);
  if (lighting_of(options) == Lighting::Lamp)
    return shown;
  const renderer::Light light(shown.film.light, probe::Lookup::Nearest);
  shown.light = pack_light(light.map(1 << light_level_of(options)));
  for (int axis = 0; axis < 3; ++axis)
    shown.to_world.col(axis) = light.to_world(Vec3::Unit(axis));
  return shown;
}

void set(const PageOptions& shown, FrameDrawer& drawer) {
  drawer.set_lamp(shown.lamp);
  drawer.set_tolerance(shown.tolerance);
  drawer.turn_light(shown.to_world);
  drawer.show_background(shown.film.light.background);
  if (shown.light)
    drawer.set_light(*shown.light);
}

void draw_frame(const ViewScene& scene, const PageOptions& shown, const Options& options,
                tool::Report& report) {
  const EglContext context;
  FrameDrawer drawer(scene, shown.film.width, shown.film.height);
  set(shown, drawer);
  const Lighting lighting = lighting_of(options);
  const Drawing drawing = {[&](int level) { return drawer.draw(lighting, level); },
                           [&] { return drawer.read(); }, options.repeat};
  drawing.draw(shown.level); // compiles the shaders as well
  const DrawnFrame frame = drawing.read();
  write_frame(options, frame, shown.film.width, shown.film.height);
  report.add("renderer", context.renderer())
      .add("texture_bytes", drawer.texture_bytes())
      .add("accesses_per_pixel", frame.accesses)
      .add("ms_per_frame", drawing.time(shown.level), "ms");
  if (shown.reference.empty())
    return;
  drawer.show_background(false);
  add_comparison(drawing, shown.level, finest_level(scene, options), shown.reference, report);
}

void write_page(const ViewScene& scene, PageOptions shown, const Options& options,
                tool::Report& report) {
  shown.title = base_name(options.input);
  shown.provenance = version_text() + ", " + shown.title + " " + file_hash(options.input);
  const std::string page = view_page(scene, shown);
  OutputFile file(options.page);
  file.write(page.data(), page.size());
  file.commit();
  report.add("page", options.page).add("page_bytes", page.size());
}

int view_scene(const tool::Tool& app, const Options& options) {
  check(app, options);
  if (app.given("--threads"))
    setenv("LP_NUM_THREADS", std::to_string(thread_count()).c_str(), 1); // llvmpipe's own
  if (is_transfer(options.input))
    return view_transfer(app, options);
  check_scene(app);
  if (shows_window(options))
    return view_in_window(app, options);
  const ViewScene scene(options.input);
  tool::check_sources(app, scene.description());
  const PageOptions shown = shown_of(scene, options);
  tool::Report report;
  report.add("width", shown.film.width, "px")
      .add("height", shown.film.height, "px")
      .add("level", options.level ? std::to_string(*options.level) : std::string("as needed"))
      .add("trees", scene.trees().size());
  if (!options.page.empty())
    write_page(scene, shown, options, report);
  if (!options.frame.empty())
    draw_frame(scene, shown, options, report);
  app.print(report);
  return tool::exit_ok;
}

} // namespace

int main(int argc, char** argv) {
  return tool::run_program(
      argc, argv,
      tool::command("haarview",
                    "Shows trees by GL in a window, a picture or a page: a fragment shader "
                    "reconstructs them at the level each pixel needs.",
                    declare, view_scene));
}
