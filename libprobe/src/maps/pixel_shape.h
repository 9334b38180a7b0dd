#pragma once
// The part of a pixel that lies in the disk of a round map.

#include <algorithm>
#include <cmath>

namespace haarlight::probe {

/// One pixel of a round map as a rectangle in a, b ∈ [−1, 1] (b may point either way).
struct PixelRectangle {
  float a0, a1, b0, b1;

  PixelRectangle(int x, int y, int width, int height)
      : a0(edge(x, width)), a1(edge(x + 1, width)), b0(edge(y, height)), b1(edge(y + 1, height)) {}

  /// Whether some of it lies outside the disk.
  bool crosses_rim() const {
    const float a = std::max(std::abs(a0), std::abs(a1));
    const float b = std::max(std::abs(b0), std::abs(b1));
    return a * a + b * b > 1.0F;
  }

  /// Whether all of it does.
  bool is_outside() const {
    const float a = least(a0, a1);
    const float b = least(b0, b1);
    return a * a + b * b >= 1.0F;
  }

  /// The values of a at which the pixel meets the disk; the disk being convex they are one
  /// interval.
  void columns(float& from, float& to) const { cut(a0, a1, least(b0, b1), from, to); }

  /// The values of b that lie in both at one such a.
  void rows(float a, float& from, float& to) const { cut(b0, b1, a, from, to); }

private:
  static float edge(int i, int count) {
    return 2.0F * static_cast<float>(i) / static_cast<float>(count) - 1.0F;
  }
  static float least(float low, float high) { return low > 0 ? low : (high < 0 ? -high : 0.0F); }
  static void cut(float low, float high, float other, float& from, float& to) {
    const float half = std::sqrt(std::max(0.0F, 1.0F - other * other));
    from = std::max(low, -half);
    to = std::max(from, std::min(high, half));
  }
};

} // namespace haarlight::probe
