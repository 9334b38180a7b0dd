#include <view/commands.h>
#include <view/comparison.h>
#include <view/page.h>

#include <html/page.h>
#include <render/film_output.h>

#include <image/png.h>

#include <renderer/light/light.h>
#include <wavelet/file/input_file.h>
#include <wavelet/file/provenance.h>
#include <wavelet/file/tree_set.h>

namespace haarlight::view {
namespace {

using renderer::SceneDescription;

PunctualLight punctual_light(const Options& options) {
  const auto vec = [](const std::vector<double>& v) {
    return Vec3(Eigen::Vector3d(v.data()).cast<float>());
  };
  PunctualLight light;
  light.is_point = !options.position.empty();
  light.place = vec(light.is_point ? options.position : options.direction);
  light.irradiance = vec(options.irradiance);
  if (!light.is_point && light.place.stableNorm() < 1e-18F)
    throw tool::UsageError("--light-direction: has length 0; expected any other vector");
  return light;
}

/// Level of the light's squares: lower in a page, which would be large.
int light_level(const Options& options) {
  return options.light_level.value_or(options.frame.empty() ? 8 : 10);
}

void require_light(const Options& options, const SceneDescription& scene) {
  if (options.environment && options.probe.empty() && scene.light.probe.empty() &&
      scene.light.haar.empty())
    throw tool::UsageError("--environment: no scene names a light; give one by --probe");
}

/// The scene with the film size and the light of the command line.
SceneDescription adjusted_scene(const ViewScene& scene, const Options& options) {
  SceneDescription result = scene.description();
  if (!options.size.empty())
    tool::set_film_size(options.size, result);
  if (!options.probe.empty()) {
    const bool trees = wavelet::begins_as_tree_set(InputFile(options.probe));
    result.light.probe = trees ? "" : options.probe;
    result.light.haar = trees ? options.probe : "";
  }
  require_light(options, result);
  return result;
}

ViewState view_state(const SceneDescription& scene, const Options& options) {
  ViewState state;
  state.camera = scene.camera;
  state.width = scene.width;
  state.height = scene.height;
  state.punctual = punctual_light(options);
  state.background = scene.light.background;
  state.tolerance = options.tolerance;
  state.level = options.level.value_or(automatic_level);
  if (!options.uses_environment())
    return state;
  const renderer::Light light(scene.light, probe::Lookup::Nearest);
  state.environment =
      std::make_shared<const PackedLight>(pack_light(light.map(1 << light_level(options))));
  state.to_world = light_to_world(light);
  return state;
}

/// The reference picture; empty if there is no comparison.
std::vector<float> reference_frame(const ViewScene& scene, const SceneDescription& adjusted,
                                   const ViewState& state, const Options& options) {
  if (!options.reference.empty())
    return read_reference(options.reference, state.width, state.height);
  if (!options.compare)
    return {};
  return options.uses_environment() ? cpu_environment_frame(adjusted, state.width, state.height)
                                    : cpu_punctual_frame(scene, state);
}

void draw_frame(const ViewScene& scene, ViewState state, const std::vector<float>& reference,
                const Options& options, tool::Report& report) {
  const EglContext context;
  SceneDrawer drawer(scene);
  const auto draw = [&](int level) {
    state.level = level;
    return drawer.draw(state);
  };
  const FrameTest test = {drawer, draw, state.level, options.repeat};
  const DrawnFrame frame = test.write(options.frame, state.width, state.height, options.exposure);
  report.add("renderer", renderer_name())
      .add("texture_bytes", drawer.texture_bytes())
      .add("accesses_per_pixel", frame.accesses)
      .add("ms_per_frame", test.time(), "ms");
  if (reference.empty())
    return;
  state.background = false;
  test.compare(reference, options.uses_environment() ? light_level(options) : scene.levels(),
               report);
}

void write_page(const ViewScene& scene, const ViewState& state, const std::vector<float>& reference,
                const Options& options, tool::Report& report) {
  const std::string title = base_name(options.input);
  const std::string page =
      view_page(scene, {title, version_text() + ", " + title + " " + file_hash(options.input),
                        state, options.exposure, reference});
  html::write_text(options.page, page);
  report.add("page", options.page).add("page_bytes", page.size());
}

WindowInput window_input(const Options& options) {
  WindowInput input;
  if (!options.size.empty()) {
    SceneDescription film;
    tool::set_film_size(options.size, film);
    input.width = film.width;
    input.height = film.height;
  }
  input.scene = options.input;
  input.second = options.second;
  input.materials = options.materials;
  input.level = options.level;
  input.punctual = punctual_light(options);
  input.environment = options.uses_environment();
  input.probe = options.probe;
  input.light_level = options.light_level.value_or(input.light_level);
  input.tolerance = options.tolerance;
  input.exposure = options.exposure;
  input.watch = options.watch;
  input.panel = !options.no_panel;
  input.script = options.script;
  return input;
}

} // namespace

int view_scene(const tool::Tool& app, const Options& options) {
  if (options.shows_window()) {
    if (options.environment)
      require_light(options, describe_view(options.input));
    return report_window(
        app, options,
        show_window(window_input(options), [&](const std::string& line) { app.note(line); }));
  }
  const ViewScene scene(options.input);
  tool::check_sources(app, scene.description());
  const SceneDescription adjusted = adjusted_scene(scene, options);
  const ViewState state = view_state(adjusted, options);
  const std::vector<float> reference = reference_frame(scene, adjusted, state, options);
  tool::Report report;
  report.add("width", state.width, "px")
      .add("height", state.height, "px")
      .add("level", options.level ? std::to_string(*options.level) : std::string("as needed"))
      .add("trees", scene.trees().size());
  if (!options.page.empty())
    write_page(scene, state, reference, options, report);
  if (!options.frame.empty())
    draw_frame(scene, state, reference, options, report);
  app.print(report);
  return tool::exit_ok;
}

int report_window(const tool::Tool& app, const Options& options, const WindowReport& window) {
  if (window.screenshot.width > 0)
    image::write_png(options.screenshot, window.screenshot);
  tool::Report report;
  report.add("renderer", window.renderer)
      .add("width", window.width, "px")
      .add("height", window.height, "px")
      .add("frames", window.frames)
      .add("accesses_per_pixel", window.accesses)
      .add("ms_per_frame", window.milliseconds, "ms");
  if (options.watch)
    report.add("reloads", window.reloads).add("refused_reloads", window.failed_reloads);
  app.print(report);
  return tool::exit_ok;
}

} // namespace haarlight::view
