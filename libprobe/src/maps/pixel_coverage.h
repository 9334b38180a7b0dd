#pragma once
// Which map pixels a pixel of another picture covers, and how much of each.

#include "mapping/point_kernels.h"
#include "maps/area_raster.h"

#include <cstdint>
#include <vector>

namespace haarlight::probe {

/// Part of a world-map pixel that one source pixel covers.
struct CoveredPixel {
  std::uint32_t index = 0; ///< row · size + column
  float fraction = 0;      ///< of the map pixel's area, 0 to 1
};

/// Deviation of a cell's edges from straight lines that is accepted, in sides of the source pixel.
struct Flatness {
  float value = 0.004F;
};

/// Projects the pixels of a picture to the square of a frame, as polygons whose vertices
/// neighbouring pixels share, and clips them against the map's pixels. With the default flatness
/// the fractions of all source pixels in one map pixel add up to 1, those of one source pixel to
/// its solid angle, both within about 0.1 %.
class PixelCoverage {
public:
  /// @param map_size pixels along the map's side, even
  /// @param frame    the map's axes in those of the picture
  PixelCoverage(const PictureShape& shape, int map_size, const Frame& frame = {},
                Flatness flatness = {})
      : m_shape(shape), m_size(map_size), m_frame(frame), m_flatness(flatness.value) {}

  /// Appends the map pixels that pixel (x, y) covers; one may appear several times.
  void append(int x, int y, std::vector<CoveredPixel>& out);

private:
  PictureShape m_shape;
  int m_size;
  Frame m_frame;
  float m_flatness;
  AreaRaster m_raster;
};

} // namespace haarlight::probe
