#pragma once
// Map sets as one tiled EXR: tile (column, row) is map (column, row), so that any viewer shows the
// table and any map can be read alone. Float R, G, B, ZIP. Header attributes haarlight:* hold every
// field of SetInfo.

#include <image/image_exr.h>

#include <wavelet/file/output_file.h>
#include <wavelet/tree/map_set.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace haarlight::image {

struct MapSetResult {
  std::optional<wavelet::Conservation> conservation; ///< where the source knows its integrals
  std::uint64_t bytes = 0;                           ///< of the file
};

/// Makes all maps, several at a time, and writes them; memory is bounded by a few maps. The bytes
/// do not depend on the number of threads. The caller commits with commit_exr().
/// @throws Error(Output), and whatever the source throws
MapSetResult write_map_set_exr(const wavelet::MapSource& source, OutputFile& file,
                               const wavelet::Progress& progress = {});

/// The maps of such a file, read tile by tile from several threads. An ordinary square EXR image of
/// R, G, B (or Y) channels and a power of two of pixels a side is taken as a set of one map of kind
/// Generic.
class ExrMapSource : public wavelet::MapSource {
public:
  /// @throws Error(Input) for a file that is unreadable, no such EXR, truncated or inconsistent
  explicit ExrMapSource(const std::string& path);
  ~ExrMapSource() override;

  const wavelet::SetInfo& info() const override;
  /// @throws Error(Input) for damaged data, and for pixels that are not finite, naming the first
  wavelet::Map make(int column, int row) const override;

private:
  class Reader;
  std::unique_ptr<Reader> m_reader;
};

} // namespace haarlight::image
