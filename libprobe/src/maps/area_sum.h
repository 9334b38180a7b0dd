#pragma once
// Sums of source pixels by the exact area of each map pixel that they cover, and the few pixels of
// a probe that need it because sampling could miss them or count them twice.

#include "mapping/point_kernels.h"

#include <probe/probe_maps.h>

#include <wavelet/base/lanes.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace haarlight::probe {

/// A pixel of a probe's picture.
struct PixelPlace {
  int x = 0;
  int y = 0;
};

/// The pixels brighter than `contrast` times the mean of the 24 around them, row by row: lights of
/// few pixels and the corners of wider ones. At 3 these are lights of up to 2 × 2 pixels, at 2 of
/// up to 3 × 3.
std::vector<PixelPlace> find_peaks(const Probe& probe, double contrast = 3);

/// A power of two by which the probe's radiances are divided so that sums of samples stay finite; 1
/// for all but extreme ones.
float radiance_unit(const Probe& probe);

/// Exact areas of a polygon in the pixels of a grid. Collects the area that a closed polygon covers
/// of each pixel, edge by edge: every edge adds the signed area between itself and the right end of
/// its rows. The sum over the edges is the area covered, positive for one orientation of the
/// polygon and negative for the other.
class AreaRaster {
public:
  /// Starts with pixels [left, left + width) × [top, top + height), all empty.
  void reset(int left, int top, int width, int height);

  /// @param from, to in pixels; points outside of the grid are moved to its edge
  void add_edge(const Vec2& from, const Vec2& to);

  /// Calls visit(x, y, area) for each pixel that an edge or the inside touches.
  template <class Visit>
  void visit(Visit&& visit) const {
    for (int row = 0; row < m_height; ++row) {
      const float* steps = m_steps.data() + start_of(row);
      float area = 0;
      for (int column = 0; column < m_width; ++column) {
        area += steps[column];
        if (area != 0)
          visit(m_left + column, m_top + row, area);
      }
    }
  }

private:
  std::size_t start_of(int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(m_width + 2);
  }
  void add_in_row(float* steps, float x0, float x1, float height) const;

  int m_left = 0;
  int m_top = 0;
  int m_width = 0;
  int m_height = 0;
  /// Differences of the areas along each row, two more than there are pixels: the running sum is
  /// the area.
  std::vector<float> m_steps;
};

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

/// Adds source pixels to a map. The part of a map pixel that they leave uncovered is filled with
/// another mean, so that every value is a convex combination of radiances.
class AreaSum {
public:
  /// @param size pixels along the map's side, even
  explicit AreaSum(int size);

  /// Pixels are clipped in parallel and added in their order.
  /// @param coverage of the pixels' picture in a map of the same size
  void add(const PixelCoverage& coverage, std::span<const SourcePixel> pixels);

  /// The mean over map pixel (x, y).
  /// @param others mean over the part that no added pixel covers
  /// @param layers how many times the sphere was added; the result is the mean of the layers
  Rgb mean(int x, int y, const Rgb& others, float layers = 1) const;

  /// Mean over the covered part alone; 0 where nothing is covered.
  Rgb covered_mean(int x, int y) const;

private:
  struct Group;
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(m_size) +
           static_cast<std::size_t>(x);
  }
  void add_covered(const Rgb& radiance, std::span<const CoveredPixel> covered);

  int m_size;
  std::vector<float> m_rgb;     ///< sums of radiance · fraction
  std::vector<float> m_covered; ///< sums of fractions
};

/// A pixel of four floats.
inline Float4 load_pixel(const float* values) {
  Float4 result;
  __builtin_memcpy(&result, values, sizeof result);
  return result;
}

} // namespace haarlight::probe
