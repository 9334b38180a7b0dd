#pragma once
// Exact areas of polygons in the pixels of a grid.

#include <wavelet/base/geometry.h>

#include <cstddef>
#include <vector>

namespace haarlight::probe {

/// Collects the area that a closed polygon covers of each pixel, edge by edge: every edge adds the
/// signed area between itself and the right end of its rows. The sum over the edges is the area
/// covered, positive where the polygon turns one way and negative where it turns the other.
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

} // namespace haarlight::probe
