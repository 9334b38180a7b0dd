#pragma once
// A picture in memory: what the picture writers and readers exchange.

#include <wavelet/base/geometry.h>

#include <cstddef>
#include <vector>

namespace haarlight::image {

/// Linear Rec. 709 RGB, interleaved, row 0 at the top, x to the right.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;

  Picture() = default;
  Picture(int w, int h)
      : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

  std::size_t offset(int x, int y) const {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x));
  }
  Rgb at(int x, int y) const { return Eigen::Map<const Rgb>(rgb.data() + offset(x, y)); }
  void set(int x, int y, const Rgb& value) { Eigen::Map<Rgb>(rgb.data() + offset(x, y)) = value; }
};

} // namespace haarlight::image
