#pragma once
// What every program that makes maps does with them: one tiled EXR, or a compressed .haar file.

#include <support/tool.h>

#include <wavelet/transform/compress.h>
#include <wavelet/tree/map_set.h>

#include <optional>
#include <string>

namespace haarlight::tool {

/// Where maps go. Declare one, pass it to add_map_output() before and to write_map_set() inside
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

/// @throws UsageError if one of them was given that changes trees: any but --pack
void refuse_threshold_options(const Tool& tool);

/// Declares -o, the compression options, --conservation-tolerance and --json.
void add_map_output(Tool& tool, MapOutput& output);

/// Makes and writes all maps and prints one report, whose first lines are those of `report`. Both
/// ways to a .haar file, direct or by an EXR, give the same bytes.
/// @return exit_ok, or exit_no (and no file) if the maps miss the source's integrals by more than
///         the tolerance
/// @throws UsageError for an unknown extension or contradicting options, and whatever source and
///         file throw
int write_map_set(const Tool& tool, const wavelet::MapSource& source, const MapOutput& output,
                  Report report = {});

} // namespace haarlight::tool
