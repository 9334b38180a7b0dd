#include <support/map_output.h>

#include <support/map_report.h>
#include <support/output_size.h>
#include <support/progress.h>
#include <support/words.h>

#include <image/map_set_exr.h>

#include <wavelet/file/output_file.h>

#include <cmath>

namespace haarlight::tool {
namespace {

using wavelet::CompressOptions;
using wavelet::CompressReport;
using wavelet::Conservation;

/// Does what both kinds of output have in common once all is written but not yet in place.
int finish(const Tool& tool, const MapOutput& output, std::optional<Conservation> conservation,
           const std::function<void()>& commit, std::uint64_t bytes, Report& report) {
  bool within = true;
  if (conservation) {
    describe(*conservation, output.conservation_tolerance, report);
    within = std::abs(conservation->mean_error) <= output.conservation_tolerance;
  }
  if (!within) {
    tool.print(report);
    tool.note(output.path + ": not written: the maps miss the source's integrals by " +
              short_text(conservation->mean_error) + ", more than the tolerance of " +
              short_text(output.conservation_tolerance));
    return exit_no;
  }
  commit();
  report.add("bytes", bytes).add("output", output.path);
  tool.print(report);
  return exit_ok;
}

int write_exr_set(const Tool& tool, const wavelet::MapSource& source, const MapOutput& output,
                  Report& report) {
  refuse_compress_options(tool);
  OutputFile file(output.path);
  require_room(output.path, exr_set_size(source.info()), output.force);
  image::MapSetResult result;
  {
    ProgressBar bar(tool, "making maps");
    result = image::write_map_set_exr(source, file, bar.callback());
  }
  const auto commit = [&] { image::commit_exr(file); };
  return finish(tool, output, result.conservation, commit, result.bytes, report);
}

/// Of a link and the coefficients of a node.
std::uint64_t node_bytes(const CompressOptions& options) {
  return 4 + (options.luminance ? 3 : 9) * wavelet::coefficient_bytes(options.coefficients);
}

int write_haar_set(const Tool& tool, const wavelet::MapSource& source, const MapOutput& output,
                   Report& report) {
  const CompressOptions options = compress_options(output, source.info());
  OutputFile file(output.path);
  require_room(output.path, haar_set_size(source.info(), node_bytes(options)), output.force);
  CompressReport result;
  {
    ProgressBar bar(tool, "compressing maps");
    result = wavelet::compress_set(source, options, file, bar.callback());
  }
  describe(result, options, report);
  const auto commit = [&] { file.commit(); };
  return finish(tool, output, result.conservation, commit, result.bytes, report);
}

} // namespace

void add_map_output(Tool& tool, MapOutput& output) {
  tool.output(
      output.path, "OUT.exr|OUT.haar",
      "Map set to write: one tiled EXR, or compressed to a .haar file (a pipe takes the EXR)");
  add_compress_options(tool, output);
  add_force(tool, output.force);
  tool.value(output.conservation_tolerance, "--conservation-tolerance",
             "Largest relative error of the set's total integral; past it the exit code is 1", 0,
             1e9);
  tool.offer_json();
}

int write_map_set(const Tool& tool, const wavelet::MapSource& source, const MapOutput& output,
                  Report report) {
  describe_set(source.info(), report);
  const bool stream = output.path == standard_output;
  if (stream ? output.stream_trees : has_extension(output.path, ".haar"))
    return write_haar_set(tool, source, output, report);
  if (stream || has_extension(output.path, ".exr"))
    return write_exr_set(tool, source, output, report);
  throw UsageError("--output: '" + output.path + "' ends in neither .exr nor .haar");
}

} // namespace haarlight::tool
