#pragma once
// A rectangular RGB raster in memory: probes, pictures and what their readers and writers exchange.

#include <wavelet/base/geometry.h>

#include <cstddef>
#include <vector>

namespace haarlight {

/// Linear RGB (Rec. 709 primaries), interleaved, row 0 at the top, column 0 at the left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;

  Image() = default;
  /// All black.
  Image(int columns, int rows)
      : width(columns), height(rows),
        rgb(3 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x));
  }
  Rgb at(int x, int y) const { return Eigen::Map<const Rgb>(rgb.data() + offset(x, y)); }
  void set(int x, int y, const Rgb& value) { Eigen::Map<Rgb>(rgb.data() + offset(x, y)) = value; }
};

} // namespace haarlight
