// haarrelight: pixels as products of all factors of their integrals but one, and pictures as that
// factor changes.
#include <relight/session.h>
#include <render/film_output.h>
#include <support/arguments.h>
#include <support/output_size.h>
#include <support/progress.h>
#include <support/tool.h>

#include <image/contact_sheet.h>
#include <image/png.h>

#include <renderer/scene/scene.h>
#include <renderer/transfer/transfer.h>
#include <wavelet/file/tree_set.h>

#include <bit>
#include <chrono>
#include <cstdio>

using namespace haarlight;
using namespace haarlight::renderer;
using namespace haarlight::tool;

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// haarrelight build: the transfer of every pixel, as trees.

struct BuildOptions {
  std::string scene;
  std::string output;
  std::string vary = "light";
  std::string size;
  int resolution = 128;
  std::optional<double> tolerance;
  bool pack = false;
  bool force = false;
  wavelet::ProjectionOptions projection;
};

void declare_build(Tool& app, BuildOptions& options) {
  app.input(options.scene, "SCENE.json", "Scene; renderer/SCENE.md documents the format");
  app.output(options.output, "T.haar", "Transfer to write: one tree per pixel");
  app.text(options.vary, "--vary", "WHAT",
           "The factor that may change later: light, object:NAME (or its number in the scene, from "
           "0), material:NAME, or view");
  app.text(options.size, "--size", "WxH", "Size of the film in pixels [the scene's]");
  app.value(options.resolution, "--resolution",
            "Finest squares along a side of the transfer's maps, a power of two from 4 to 4096", 4,
            4096);
  app.value(options.tolerance, "--tolerance",
            "Bound of the relative root mean square error that thresholding causes in the "
            "contribution of one small light to a pixel; the error of pictures with many lights is "
            "far smaller; 0.0001 to 100 [light 0.15, object 0.8, material and view 0.5]",
            0.0001, 100);
  app.flag(options.pack, "--pack",
           "Write the packed form: several times smaller, slower to write and to open");
  add_force(app, options.force);
  app.offer_json();
}

Variation variation_of(const SceneDescription& scene, const std::string& text) {
  try {
    return variation_from_text(scene, text);
  } catch (const std::invalid_argument& problem) {
    throw UsageError(std::string("--vary: ") + problem.what());
  }
}

wavelet::SetInfo info_of(const SceneDescription& scene, const Variation& variation,
                         const BuildOptions& options) {
  wavelet::SetInfo info =
      transfer_info(scene, variation, options.projection, scene.width, scene.height);
  set_sources(scene, info.provenance);
  return info;
}

std::unique_ptr<wavelet::TreeSink> make_sink(OutputFile& file, const wavelet::SetInfo& info,
                                             const BuildOptions& options) {
  if (options.pack)
    return std::make_unique<wavelet::PackedSetWriter>(file, info, 3,
                                                      options.projection.coefficients);
  return std::make_unique<wavelet::TreeSetWriter>(file, info, 3, options.projection.coefficients);
}

Report describe(const TransferReport& report, std::uint64_t bytes, double seconds,
                const BuildOptions& options) {
  const double pixels = std::max(static_cast<double>(report.pixels), 1.0);
  Report result;
  result.add("vary", options.vary)
      .add("pixels", report.pixels)
      .add("nodes_per_pixel", static_cast<double>(report.nodes) / pixels)
      .add("squares_per_pixel", report.mean_squares)
      .add("relative_error", report.error)
      .add("unresolved_error", report.unresolved)
      .add("bytes", bytes)
      .add("seconds", seconds, "s")
      .add("microseconds_per_pixel", 1e6 * seconds / pixels, "us")
      .add("output", options.output);
  return result;
}

int build(const Tool& app, BuildOptions& options) {
  if (!std::has_single_bit(static_cast<unsigned>(options.resolution)))
    throw UsageError("--resolution: must be a power of two");
  options.projection.levels = std::countr_zero(static_cast<unsigned>(options.resolution));
  SceneDescription scene = load_scene(options.scene);
  if (!options.size.empty())
    set_film_size(options.size, scene);
  if (scene.width > 65536 || scene.height > 65536)
    throw UsageError("--size: a transfer has at most 65536 pixels along a side");
  check_sources(app, scene);
  const Variation variation = variation_of(scene, options.vary);
  options.projection.tolerance =
      options.tolerance.value_or(default_transfer_tolerance(variation.varying));
  OutputFile file(options.output);
  require_room(options.output, transfer_size(scene.width, scene.height), options.force);
  const LoadedScene loaded(scene, SourceLookups(), SamplerKind::Product, false);
  const auto start = std::chrono::steady_clock::now();
  const auto sink = make_sink(file, info_of(scene, variation, options), options);
  ProgressBar bar(app, "building");
  const TransferReport report = build_transfer(loaded, variation, options.projection, scene.width,
                                               scene.height, *sink, bar.callback());
  sink->finish();
  const double seconds = seconds_since(start);
  const std::uint64_t bytes = file.position();
  file.commit();
  app.print(describe(report, bytes, seconds, options));
  return exit_ok;
}

// haarrelight apply: one picture with the varying factor changed.

struct ApplyOptions {
  ChangeOptions change;
  std::string output;
  std::string image;
  double exposure = 0;
  std::vector<double> rotate = {0, 0, 0};
  std::vector<double> move = {0, 0, 0};
};

void declare_apply(Tool& app, ApplyOptions& options) {
  declare_change(app, options.change);
  app.output(options.output, "OUT.exr", "Picture to write: R, G, B");
  app.values(options.rotate, "--rotate",
             "light: rotation by yaw, pitch, roll in degrees, about the world's +y, then +x, then "
             "+z, added to the scene's rotation",
             3, -1e6, 1e6);
  app.values(options.move, "--move",
             "object, view: translation x,y,z of the object or the eye from its place in the "
             "scene, world units",
             3, -1e6, 1e6);
  app.optional_output(options.image, "--image", "OUT.png", "Tone-mapped picture to write as well");
  app.value(options.exposure, "--exposure", "Exposure of --image, stops", -30, 30);
  app.alias("--png", "--image");
  app.offer_json();
}

int apply(const Tool& app, ApplyOptions& options) {
  if (has_extension(options.image, ".exr"))
    throw UsageError("--image: '" + options.image + "' is written as PNG; -o writes the EXR");
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
  if (!options.image.empty())
    write_film_png(options.image, film, options.exposure);
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

// haarrelight sweep: a sequence of pictures as the varying factor changes.

struct SweepOptions {
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

void declare_sweep(Tool& app, SweepOptions& options) {
  declare_change(app, options.change);
  app.output(options.output, "OUT.png",
             "Contact sheet to write; the pictures are written beside it as OUT-0000.png, "
             "OUT-0001.png, ...",
             Stream::No);
  app.value(options.frames, "--pictures", "Number of pictures", 1, 10000);
  app.alias("--frames", "--pictures");
  app.value(options.thumbnails, "--on-sheet", "Maximum number of pictures on the contact sheet", 1,
            400);
  app.values(options.rotate_from, "--rotate-from",
             "light: rotation of the first picture, as --rotate of apply", 3, -1e6, 1e6);
  app.values(options.rotate_to, "--rotate-to",
             "light: rotation one step after the last picture, so that a full turn can be repeated",
             3, -1e6, 1e6);
  app.values(options.move_from, "--move-from",
             "object, view: translation of the first picture, as --move of apply", 3, -1e6, 1e6);
  app.values(options.move_to, "--move-to", "object, view: translation of the last picture", 3, -1e6,
             1e6);
  app.value(options.exposure, "--exposure", "Exposure, stops", -30, 30);
  app.offer_json();
}

Eigen::Vector3d between(const std::vector<double>& from, const std::vector<double>& to, double t) {
  const Eigen::Map<const Eigen::Vector3d> a(from.data());
  const Eigen::Map<const Eigen::Vector3d> b(to.data());
  return a + t * (b - a);
}

Change change_at(const SweepOptions& options, int frame) {
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

Image picture_of(const Film& film, const SweepOptions& options) {
  Image picture(film.width, film.height);
  picture.rgb = film.rgb;
  image::tone_map(picture, {options.exposure, image::ToneMap::Filmic});
  return picture;
}

int sweep(const Tool& app, SweepOptions& options) {
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
    seconds += seconds_since(start);
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

int main(int argc, char** argv) {
  return run_program(
      argc, argv, "haarrelight",
      "Stores each pixel's product of all factors but one as a tree, and makes pictures as that "
      "factor changes.",
      {command(
           "build",
           "Computes the transfer: for each pixel the product of all factors but one, as a tree.",
           declare_build, build),
       command("apply", "Makes one picture with the varying factor changed.", declare_apply, apply),
       command("sweep",
               "Makes a sequence of pictures as the varying factor changes, and a contact sheet.",
               declare_sweep, sweep)});
}
