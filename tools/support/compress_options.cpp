#include <support/map_output.h>

#include <array>

namespace haarlight::tool {

using wavelet::CompressOptions;
using wavelet::Criterion;

namespace {

constexpr std::array<const char*, 6> threshold_option_names = {
    "--criterion", "--tolerance", "--keep", "--coefficients", "--luminance", "--quantize"};

void refuse(const Tool& tool, const char* name, const char* why) {
  if (tool.given(name))
    throw UsageError(std::string(name) + why);
}

} // namespace

void add_compress_options(Tool& tool, MapOutput& output) {
  CompressOptions& options = output.compression;
  tool.choice(options.threshold.criterion, "--criterion",
              {{"variance", Criterion::Variance},
               {"l2", Criterion::L2},
               {"linf", Criterion::Linf},
               {"count", Criterion::Count}},
              "What ranks the coefficients: their share in a sampler's variance, the L2 error, the "
              "largest error, or as many as --keep says");
  tool.value(output.tolerance, "--tolerance",
             "Bound of the criterion, relative; 0 keeps everything [variance 0.0005, for a light's "
             "world-frame map 0.0001; l2 0.01; linf 0.002]",
             0, 1e9);
  tool.value(output.keep, "--keep", "Coefficients to keep per map, in place of --tolerance", 0,
             1 << 30);
  tool.choice(
      options.coefficients, "--coefficients",
      {{"half", wavelet::CoefficientType::Half}, {"float", wavelet::CoefficientType::Float}},
      "Precision of stored coefficients: 16 or 32 bits");
  tool.flag(options.luminance, "--luminance", "Store the luminance in place of RGB");
  tool.flag(options.quantize, "--quantize",
            "Round what is kept as coarsely as the tolerance allows; with l2 the bound holds for "
            "both. Makes --pack's files much smaller");
  tool.flag(options.packed, "--pack",
            "Write the packed form, for transport: maps2haar --unpack gives the mapped form back");
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
    refuse(tool, name, " is for .haar files, the output is an .exr");
  refuse(tool, "--pack", " is for .haar files, the output is an .exr");
}

void refuse_threshold_options(const Tool& tool) {
  for (const char* name : threshold_option_names)
    refuse(tool, name, " is for maps, the input is a .haar file");
}

} // namespace haarlight::tool
