#pragma once
// The header of a Radiance picture.

#include "file/rgbe_colour.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace haarlight::probe {

/// The variables and the size line of a header. Scanlines run along the second axis of the size
/// line.
struct RgbeHeader {
  std::uint64_t lines = 0;               ///< extent of the first axis
  std::uint64_t length = 0;              ///< extent of the second axis, pixels of a scanline
  bool lines_are_rows = true;            ///< the first axis is Y
  bool x_reversed = false;               ///< −X: a scanline, or the scanlines, run to the left
  bool y_reversed = false;               ///< +Y: they run upwards
  std::optional<ColourMatrix> to_rec709; ///< of XYZ or foreign primaries; none for Rec. 709
  std::array<double, 3> exposure = {1, 1, 1}; ///< the factors that the pixels were multiplied by
  std::uint64_t size_offset = 0;
  std::uint64_t data_offset = 0;

  int width() const { return static_cast<int>(lines_are_rows ? length : lines); }
  int height() const { return static_cast<int>(lines_are_rows ? lines : length); }

  /// Column and row, from the top left, of pixel i of scanline s.
  std::pair<int, int> place(std::uint64_t s, std::uint64_t i) const {
    const int along_x = static_cast<int>(lines_are_rows ? i : s);
    const int along_y = static_cast<int>(lines_are_rows ? s : i);
    return {x_reversed ? width() - 1 - along_x : along_x,
            y_reversed ? height() - 1 - along_y : along_y};
  }
};

/// @throws Error(Input) with the byte offset of the offending line
RgbeHeader read_rgbe_header(std::span<const std::byte> bytes, const std::string& path);

} // namespace haarlight::probe
