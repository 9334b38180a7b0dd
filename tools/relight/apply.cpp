// haarrelight apply: one picture, as the factor that varies is changed.
#include <relight/commands.h>
#include <relight/session.h>
#include <render/film_output.h>

#include <chrono>

namespace haarlight::tool {

using namespace renderer;

namespace {

struct Options {
  ChangeOptions change;
  std::string output;
  std::string png;
  double exposure = 0;
  std::vector<double> rotate = {0, 0, 0};
  std::vector<double> move = {0, 0, 0};
};

void declare(Tool& app, Options& options) {
  declare_change(app, options.change);
  app.output(options.output, "OUT.exr", "Picture to write: R, G, B");
  app.values(options.rotate, "--rotate",
             "For --vary light: yaw, pitch, roll in degrees that the light is turned by, about the "
             "world's +y, then +x, then +z, on top of the scene's own turn",
             3, -1e6, 1e6);
  app.values(options.move, "--move",
             "Where to from the place in the scene, x, y, z in world units: the object of --vary "
             "object, or the eye of --vary view",
             3, -1e6, 1e6);
  app.optional_output(options.png, "--png", "OUT.png", "Write a tone-mapped preview too");
  app.value(options.exposure, "--exposure", "Stops that the preview is brightened by", -30, 30);
  app.offer_json();
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int apply(const Tool& app, Options& options) {
  const auto start = std::chrono::steady_clock::now();
  RelightSession session(app, options.change);
  const double open_seconds = seconds_since(start);
  Change change;
  change.rotate = Eigen::Map<const Eigen::Vector3d>(options.rotate.data());
  change.move = Eigen::Map<const Eigen::Vector3d>(options.move.data()).cast<float>();
  const auto picture_start = std::chrono::steady_clock::now();
  const Film film = session.make(change);
  const double seconds = seconds_since(picture_start);
  write_relit_exr(options.output, film, session.transfer(), options.change, change);
  if (!options.png.empty())
    write_film_png(options.png, film, options.exposure);
  Report report;
  report.add("vary", session.transfer().varying_text())
      .add("width", film.width, "px")
      .add("height", film.height, "px")
      .add("open_seconds", open_seconds, "s")
      .add("seconds", seconds, "s")
      .add("output", options.output);
  app.print(report);
  return exit_ok;
}

} // namespace

Command apply_command() {
  return command("haarrelight", "apply", "Makes one picture with the varying factor changed.",
                 declare, apply);
}

} // namespace haarlight::tool
