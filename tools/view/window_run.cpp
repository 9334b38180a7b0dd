#include <view/window_run.h>

#include <render/film_output.h>

#include <image/png.h>

namespace haarlight::view {
namespace {

WindowInput input_of(const Options& options) {
  WindowInput input = options.window.input;
  if (!options.size.empty()) {
    renderer::SceneDescription film;
    tool::set_film_size(options.size, film);
    input.width = film.width;
    input.height = film.height;
  }
  input.scene = options.input;
  input.level = options.level;
  input.lamp = lamp_of(options);
  input.lighting = lighting_of(options);
  input.probe = options.probe;
  input.light_level = options.light_level.value_or(input.light_level);
  input.tolerance = options.tolerance;
  input.exposure = options.exposure;
  input.script.screenshot = !options.window.screenshot.empty();
  return input;
}

bool names_light(const std::string& scene) {
  const renderer::LightDescription light = describe_view(scene).light;
  return !light.probe.empty() || !light.haar.empty();
}

tool::Report report_of(const WindowReport& shown, bool watched) {
  tool::Report report;
  report.add("renderer", shown.renderer)
      .add("width", shown.width, "px")
      .add("height", shown.height, "px")
      .add("frames", shown.frames)
      .add("accesses_per_pixel", shown.accesses)
      .add("ms_per_frame", shown.milliseconds, "ms");
  if (watched)
    report.add("reloads", shown.reloads).add("refused_reloads", shown.refusals);
  return report;
}

} // namespace

int view_in_window(const tool::Tool& app, const Options& options) {
  if (options.environment && options.probe.empty() && !names_light(options.input))
    throw tool::UsageError("--environment: there is no scene that names a light; --probe does");
  const WindowInput input = input_of(options);
  const WindowReport shown = show_window(input, [&](const std::string& news) { app.note(news); });
  return report_window(app, options, shown);
}

int report_window(const tool::Tool& app, const Options& options, const WindowReport& shown) {
  if (shown.picture.width > 0)
    image::write_png(options.window.screenshot, shown.picture);
  app.print(report_of(shown, options.window.input.watch));
  return tool::exit_ok;
}

} // namespace haarlight::view
