#include <support/map_output.h>

#include <support/arguments.h>
#include <support/output_size.h>
#include <support/progress.h>

#include <image/map_set_exr.h>

#include <wavelet/file/output_file.h>

#include <array>
#include <cmath>

namespace haarlight::tool {

using wavelet::CompressOptions;
using wavelet::CompressReport;
using wavelet::Conservation;
using wavelet::Criterion;

namespace {

constexpr std::array<const char*, 6> threshold_option_names = {
    "--criterion", "--tolerance", "--keep", "--coefficients", "--luminance", "--quantize"};

void refuse(const Tool& tool, const char* name, const char* why) {
  if (tool.given(name))
    throw UsageError(std::string(name) + why);
}

void describe_set(const wavelet::SetInfo& info, Report& report) {
  report.add("map_size", info.size, "px")
      .add("columns", info.columns)
      .add("rows", info.rows)
      .add("maps", info.map_count());
}

void describe(const Conservation& conservation, double tolerance, Report& report) {
  report.section("conservation")
      .add("mean_error", conservation.mean_error)
      .add("worst_error", conservation.largest_error)
      .add("worst_column", conservation.worst_column)
      .add("worst_row", conservation.worst_row)
      .add("tolerance", tolerance);
}

void describe(const CompressReport& result, const CompressOptions& options, Report& report) {
  const auto total = static_cast<double>(result.total_coefficients);
  const auto kept = static_cast<double>(result.kept_coefficients);
  Report& part = report.section("compression");
  part.add("criterion", wavelet::criterion_name(options.threshold.criterion));
  if (options.threshold.keep)
    part.add("keep", *options.threshold.keep);
  else
    part.add("tolerance", options.threshold.tolerance);
  if (options.quantize)
    part.add("quantize", true);
  part.add("coefficients", result.total_coefficients)
      .add("kept_coefficients", result.kept_coefficients)
      .add("kept_share", fraction(kept, total))
      .add("nodes", result.nodes)
      .add("relative_l2_error", result.relative_l2_error())
      .add("relative_linf_error", result.relative_linf_error())
      .add("negative_mass_share", fraction(result.negative_mass, result.mass));
}

/// Reports, checks conservation and commits an output that is completely written.
int finish(const Tool& tool, const MapOutput& output, std::optional<Conservation> conservation,
           const std::function<void()>& commit, std::uint64_t bytes, Report& report) {
  bool within = true;
  if (conservation) {
    describe(*conservation, output.conservation_tolerance, report);
    within = std::abs(conservation->mean_error) <= output.conservation_tolerance;
  }
  if (!within) {
    tool.print(report);
    tool.note(output.path + ": not written: the integrals of the maps differ from the source by " +
              short_text(conservation->mean_error) + ", which exceeds --conservation-tolerance " +
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

/// Size of a link and the coefficients of a node.
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

void add_compress_options(Tool& tool, MapOutput& output) {
  CompressOptions& options = output.compression;
  tool.choice(options.threshold.criterion, "--criterion",
              {{"variance", Criterion::Variance},
               {"l2", Criterion::L2},
               {"linf", Criterion::Linf},
               {"count", Criterion::Count}},
              "Criterion of thresholding: variance of a sampler, L2 error, maximum error, or the "
              "number of coefficients given by --keep");
  tool.value(
      output.tolerance, "--tolerance",
      "Bound of the relative error that thresholding causes, by --criterion; 0 keeps all "
      "coefficients [variance 0.0005, or 0.0001 for a world-frame light map; l2 0.01; linf 0.002]",
      0, 1e9);
  tool.value(output.keep, "--keep",
             "Number of coefficients to keep per map, instead of --tolerance", 0, 1 << 30);
  tool.choice(
      options.coefficients, "--coefficients",
      {{"half", wavelet::CoefficientType::Half}, {"float", wavelet::CoefficientType::Float}},
      "Precision of stored coefficients: 16 or 32 bits");
  tool.flag(options.luminance, "--luminance", "Store luminance instead of RGB");
  tool.flag(options.quantize, "--quantize",
            "Round the kept coefficients as coarsely as --tolerance allows, for much smaller "
            "packed files; with l2 the bound includes rounding");
  tool.flag(
      options.packed, "--pack",
      "Write the packed form, for transport; maps2haar --unpack converts it to the mapped form");
}

CompressOptions compress_options(const MapOutput& output, const wavelet::SetInfo& info) {
  CompressOptions options = output.compression;
  const bool count = options.threshold.criterion == Criterion::Count;
  if (count && !output.keep)
    throw UsageError("--criterion count needs --keep");
  if (output.tolerance && output.keep)
    throw UsageError("--tolerance and --keep exclude each other");
  options.threshold.tolerance =
      output.tolerance.value_or(wavelet::default_tolerance(info, options.threshold.criterion));
  if (output.keep)
    options.threshold.keep = static_cast<std::size_t>(*output.keep);
  return options;
}

void refuse_compress_options(const Tool& tool) {
  for (const char* name : threshold_option_names)
    refuse(tool, name, " applies to .haar files; the output is an .exr");
  refuse(tool, "--pack", " applies to .haar files; the output is an .exr");
}

void refuse_threshold_options(const Tool& tool) {
  for (const char* name : threshold_option_names)
    refuse(tool, name, " applies to maps; the input is a .haar file");
}

void add_map_output(Tool& tool, MapOutput& output) {
  tool.output(output.path, "OUT.exr|OUT.haar",
              "Map set to write: one tiled EXR, or a compressed .haar file; to a pipe an EXR");
  add_compress_options(tool, output);
  add_force(tool, output.force);
  tool.value(output.conservation_tolerance, "--conservation-tolerance",
             "Bound of the relative error of the set's total integral; exit code 1 if exceeded", 0,
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
