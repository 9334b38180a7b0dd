#pragma once
// Maps of source pixels that are added by the exact area that each covers.

#include "maps/pixel_coverage.h"

#include <probe/probe_maps.h>

#include <cstddef>
#include <span>
#include <vector>

namespace haarlight::probe {

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

} // namespace haarlight::probe
