#pragma once
// Output of map sets: one tiled EXR, or a compressed .haar file.

#include <support/tool.h>

#include <wavelet/transform/compress.h>
#include <wavelet/tree/map_set.h>

#include <optional>
#include <string>

namespace haarlight::tool {

/// Options of the output. Pass it to add_map_output() before and to write_map_set() inside
/// Tool::run().
struct MapOutput {
  std::string path;          ///< *.exr or *.haar
  bool stream_trees = false; ///< standard output gets a .haar file, not an EXR
  wavelet::CompressOptions compression;
  std::optional<double> tolerance;      ///< of thresholding, if given on the command line
  std::optional<int> keep;              ///< likewise
  bool force = false;                   ///< start even if the output is estimated not to fit
  double conservation_tolerance = 0.01; ///< largest relative error of the set's total luminance
};

/// Declares --criterion, --tolerance, --keep, --coefficients, --luminance, --quantize and --pack.
void add_compress_options(Tool& tool, MapOutput& output);

/// The compression options as given. @throws UsageError for ones that contradict each other
wavelet::CompressOptions compress_options(const MapOutput& output, const wavelet::SetInfo& info);

/// @throws UsageError if one of the compression options was given
void refuse_compress_options(const Tool& tool);

/// @throws UsageError if one that changes trees, any but --pack, was given
void refuse_threshold_options(const Tool& tool);

/// Declares -o, the compression options, --conservation-tolerance and --json.
void add_map_output(Tool& tool, MapOutput& output);

/// Computes and writes all maps and prints a report, which begins with `report`. A .haar file has
/// the same bytes whether written directly or by way of an EXR.
/// @return exit_ok, or exit_no (and no file) if the error of the integrals exceeds
///         conservation_tolerance
/// @throws UsageError for an unknown extension or contradicting options, and errors of source and
///         file
int write_map_set(const Tool& tool, const wavelet::MapSource& source, const MapOutput& output,
                  Report report = {});

} // namespace haarlight::tool
