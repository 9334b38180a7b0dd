// haarrelight build: the transfer of every pixel, as trees.
#include <relight/commands.h>
#include <render/film_output.h>
#include <support/output_size.h>
#include <support/progress.h>

#include <renderer/scene/scene.h>
#include <renderer/transfer/transfer.h>
#include <wavelet/file/tree_set.h>

#include <bit>
#include <chrono>

namespace haarlight::tool {

using namespace renderer;

namespace {

struct Options {
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

void declare(Tool& app, Options& options) {
  app.input(options.scene, "SCENE.json", "Scene; renderer/SCENE.md documents the format");
  app.output(options.output, "T.haar", "Transfer to write: a set of trees, one for each pixel");
  app.text(options.vary, "--vary", "WHAT",
           "The factor that is left out, to be moved later: light, object:NAME (or its number in "
           "the scene, from 0), material:NAME, or view [light]");
  app.text(options.size, "--size", "WxH", "Size of the film in pixels, in place of the scene's");
  app.value(options.resolution, "--resolution",
            "Finest squares along a side of the sphere's square: a power of two, 4 to 4096", 4,
            4096);
  app.value(options.tolerance, "--tolerance",
            "Relative error, root mean square, that dropping may make in what one small light adds "
            "to a pixel; far less in pictures, whose lights are many [light 0.15, object 0.8, "
            "material and view 0.5]",
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
                         const Options& options) {
  wavelet::SetInfo info =
      transfer_info(scene, variation, options.projection, scene.width, scene.height);
  set_sources(scene, info.provenance);
  return info;
}

std::unique_ptr<wavelet::TreeSink> make_sink(OutputFile& file, const wavelet::SetInfo& info,
                                             const Options& options) {
  if (options.pack)
    return std::make_unique<wavelet::PackedSetWriter>(file, info, 3,
                                                      options.projection.coefficients);
  return std::make_unique<wavelet::TreeSetWriter>(file, info, 3, options.projection.coefficients);
}

Report describe(const TransferReport& report, std::uint64_t bytes, double seconds,
                const Options& options) {
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

int build(const Tool& app, Options& options) {
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
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  const std::uint64_t bytes = file.position();
  file.commit();
  app.print(describe(report, bytes, seconds.count(), options));
  return exit_ok;
}

} // namespace

Command build_command() {
  return command("haarrelight", "build",
                 "Makes of each pixel the product of all factors but one, as a tree.", declare,
                 build);
}

} // namespace haarlight::tool
