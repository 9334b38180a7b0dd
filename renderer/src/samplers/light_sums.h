#pragma once
// A summed-area table of a probe's pixels (Crow 1984): the light of any rectangle in four look-ups,
// and points drawn in it in proportion to light.

#include <probe/probe.h>

#include <cstdint>
#include <vector>

namespace haarlight::renderer {

/// Pixels x0 ≤ x < x1, y0 ≤ y < y1.
struct PixelRange {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// A pixel's light is its luminance times its solid angle, as a whole number of units, of which
/// every pixel that shines has one at least: sums are exact, so that what is drawn has exactly the
/// density that is said.
class LightSums {
public:
  /// Keeps nothing of the probe but its shape.
  explicit LightSums(const probe::Probe& probe);

  int width() const { return m_width; }
  int height() const { return m_height; }

  /// Light of a range, in units.
  std::uint64_t sum(const PixelRange& r) const {
    return at(r.x1, r.y1) - at(r.x0, r.y1) - at(r.x1, r.y0) + at(r.x0, r.y0);
  }

  /// A point of the image, in [0, 1]², and the light of its pixel.
  struct Place {
    Vec2 uv;
    std::uint64_t light = 0;
  };

  /// Inverts the cdf of the columns of a range that shines with u, that of the column with v; the
  /// point is uniform in its pixel.
  /// @param u,v in [0, 1)
  Place draw(const PixelRange& range, double u, double v) const;

private:
  std::uint64_t at(int x, int y) const {
    return m_sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(m_width + 1) +
                  static_cast<std::size_t>(x)];
  }

  int m_width;
  int m_height;
  std::vector<std::uint64_t> m_sums; ///< of all pixels above and to the left
};

} // namespace haarlight::renderer
