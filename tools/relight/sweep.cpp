// haarrelight sweep: a sequence of pictures, as the factor that varies moves.
#include <relight/commands.h>
#include <relight/session.h>
#include <render/film_output.h>
#include <support/words.h>

#include <image/contact_sheet.h>
#include <image/png.h>

#include <chrono>
#include <cstdio>

namespace haarlight::tool {

using namespace renderer;

namespace {

struct Options {
  ChangeOptions change;
  std::string output;
  int frames = 16;
  int thumbnails = 16;
  double exposure = 0;
  std::vector<double> rotate_from = {0, 0, 0};
  std::vector<double> rotate_to = {360, 0, 0};
  std::vector<double> move_from = {-1, 0, 0};
  std::vector<double> move_to = {1, 0, 0};
};

void declare(Tool& app, Options& options) {
  declare_change(app, options.change);
  app.output(options.output, "OUT.png",
             "Contact sheet to write; the pictures go beside it, as OUT-0000.png and on",
             Stream::No);
  app.value(options.frames, "--frames", "Number of pictures", 1, 10000);
  app.value(options.thumbnails, "--on-sheet", "Pictures on the contact sheet at most", 1, 400);
  app.values(options.rotate_from, "--rotate-from",
             "For --vary light: yaw, pitch, roll in degrees of the first picture, as for apply", 3,
             -1e6, 1e6);
  app.values(options.rotate_to, "--rotate-to",
             "The same behind the last picture, so that a whole turn can be repeated", 3, -1e6,
             1e6);
  app.values(options.move_from, "--move-from",
             "For --vary object and view: where to from the place in the scene, x, y, z in world "
             "units, in the first picture",
             3, -1e6, 1e6);
  app.values(options.move_to, "--move-to", "The same in the last picture", 3, -1e6, 1e6);
  app.value(options.exposure, "--exposure", "Stops that pictures are brightened by", -30, 30);
  app.offer_json();
}

Eigen::Vector3d between(const std::vector<double>& from, const std::vector<double>& to, double t) {
  const Eigen::Map<const Eigen::Vector3d> a(from.data());
  const Eigen::Map<const Eigen::Vector3d> b(to.data());
  return a + t * (b - a);
}

Change change_at(const Options& options, int frame) {
  Change change;
  change.rotate =
      between(options.rotate_from, options.rotate_to, static_cast<double>(frame) / options.frames);
  change.move = between(options.move_from, options.move_to,
                        options.frames > 1 ? static_cast<double>(frame) / (options.frames - 1) : 0)
                    .cast<float>();
  return change;
}

/// OUT.png and 7 make OUT-0007.png.
std::string frame_path(const std::string& sheet, int frame) {
  char number[16];
  std::snprintf(number, sizeof number, "-%04d.png", frame);
  return sheet.substr(0, sheet.size() - 4) + number;
}

Image picture_of(const Film& film, const Options& options) {
  Image picture(film.width, film.height);
  picture.rgb = film.rgb;
  image::tone_map(picture, {options.exposure, image::ToneMap::Filmic});
  return picture;
}

int sweep(const Tool& app, Options& options) {
  if (!has_extension(options.output, ".png"))
    throw UsageError("--output: " + options.output + " does not end in .png");
  for (int frame = 0; frame < options.frames; ++frame)
    app.writes("a picture", frame_path(options.output, frame));
  RelightSession session(app, options.change);
  std::vector<image::SheetEntry> entries;
  double seconds = 0;
  const int every = (options.frames + options.thumbnails - 1) / options.thumbnails;
  for (int frame = 0; frame < options.frames; ++frame) {
    const auto start = std::chrono::steady_clock::now();
    const Film film = session.make(change_at(options, frame));
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    image::SheetEntry entry{picture_of(film, options), std::to_string(frame)};
    image::write_png(frame_path(options.output, frame), entry.picture);
    if (frame % every == 0)
      entries.push_back(std::move(entry));
  }
  image::write_png(options.output, image::contact_sheet(entries));
  Report report;
  report.add("vary", session.transfer().varying_text())
      .add("frames", options.frames)
      .add("seconds", seconds, "s")
      .add("pictures_per_second", options.frames / std::max(seconds, 1e-9))
      .add("output", options.output);
  app.print(report);
  return exit_ok;
}

} // namespace

Command sweep_command() {
  return command("haarrelight", "sweep",
                 "Makes a sequence of pictures as the varying factor moves, and a contact sheet.",
                 declare, sweep);
}

} // namespace haarlight::tool
