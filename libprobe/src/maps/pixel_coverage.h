#pragma once
// Which map pixels a probe pixel covers, and how much of each.

#include "maps/area_raster.h"

#include <probe/probe.h>

#include <cstdint>
#include <vector>

namespace haarlight::probe {

/// Part of a world-map pixel that one probe pixel covers.
struct CoveredPixel {
  std::uint32_t index = 0; ///< row · size + column
  float fraction = 0;      ///< of the map pixel's area, 0 to 1
};

/// Projects probe pixels to the square as polygons whose vertices neighbouring pixels share, and
/// clips them against the map's pixels. The fractions of all probe pixels in one map pixel add up
/// to 1, those of one probe pixel to its solid angle, both within about 0.1 %.
class PixelCoverage {
public:
  /// Keeps nothing of the probe but its shape.
  /// @param map_size pixels along the map's side, even
  PixelCoverage(const Probe& probe, int map_size)
      : m_mapping(probe.mapping()), m_width(probe.width()), m_height(probe.height()),
        m_size(map_size) {}

  /// Appends the map pixels that probe pixel (x, y) covers; one may appear several times.
  void append(int x, int y, std::vector<CoveredPixel>& out);

private:
  Mapping m_mapping;
  int m_width;
  int m_height;
  int m_size;
  AreaRaster m_raster;
};

} // namespace haarlight::probe
