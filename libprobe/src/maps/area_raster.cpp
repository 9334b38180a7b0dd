#include "maps/area_raster.h"

#include <algorithm>
#include <cmath>

namespace haarlight::probe {

void AreaRaster::reset(int left, int top, int width, int height) {
  m_left = left;
  m_top = top;
  m_width = width;
  m_height = height;
  m_steps.assign(start_of(height), 0.0F);
}

void AreaRaster::add_edge(const Vec2& from, const Vec2& to) {
  const auto inside = [](float value, int first, int count) {
    return std::clamp(value - static_cast<float>(first), 0.0F, static_cast<float>(count));
  };
  const float from_y = inside(from.y(), m_top, m_height);
  const float to_y = inside(to.y(), m_top, m_height);
  if (from_y == to_y)
    return;
  const bool down = from_y < to_y;
  const float y0 = down ? from_y : to_y;
  const float y1 = down ? to_y : from_y;
  const float from_x = inside(from.x(), m_left, m_width);
  const float to_x = inside(to.x(), m_left, m_width);
  const float x0 = down ? from_x : to_x;
  const float x1 = down ? to_x : from_x;
  const float slope = (x1 - x0) / (y1 - y0);
  float x = x0;
  const int last = std::min(static_cast<int>(std::ceil(y1)), m_height);
  for (int row = static_cast<int>(y0); row < last; ++row) {
    const float end = std::min(static_cast<float>(row + 1), y1);
    const float next =
        end == y1 ? x1 : std::clamp(x0 + slope * (end - y0), std::min(x0, x1), std::max(x0, x1));
    const float height = end - std::max(static_cast<float>(row), y0);
    add_in_row(m_steps.data() + start_of(row), x, next, down ? height : -height);
    x = next;
  }
}

/// The part of an edge within one row: a trapezoid in each pixel it passes, a rectangle beyond.
void AreaRaster::add_in_row(float* steps, float x0, float x1, float height) const {
  const float left = std::min(x0, x1);
  const float right = std::max(x0, x1);
  const int first = std::min(static_cast<int>(left), m_width - 1);
  const int last = std::min(static_cast<int>(right), m_width - 1);
  if (first == last) {
    const float beyond = height * (0.5F * (left + right) - static_cast<float>(first));
    steps[first] += height - beyond;
    steps[first + 1] += beyond;
    return;
  }
  const float per_pixel = height / (right - left);
  float before = 0; ///< area in the pixel before
  for (int column = first; column <= last; ++column) {
    const float from = std::max(left - static_cast<float>(column), 0.0F);
    const float to = std::min(right - static_cast<float>(column), 1.0F);
    // What has been crossed on the way to this pixel covers it whole, the part within it partly.
    const float whole = per_pixel * std::max(static_cast<float>(column) - left, 0.0F);
    const float area = whole + per_pixel * (to - from) * (1.0F - 0.5F * (from + to));
    steps[column] += area - before;
    before = area;
  }
  steps[last + 1] += height - before;
}

} // namespace haarlight::probe
