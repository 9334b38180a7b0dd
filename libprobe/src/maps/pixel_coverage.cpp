#include "maps/pixel_coverage.h"

#include "mapping/mapping_lanes.h"
#include "maps/pixel_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace haarlight::probe {
namespace {

/// Pixels of coarse probes are divided at first, so that none is wider than this part of the
/// picture.
constexpr int least_cells = 24;
/// Cells are halved until their edges are straight enough, or so often. Their outlines include the
/// middles of the edges, which leaves a quarter of the deviation.
constexpr int most_halvings = 8;
/// Slivers at the rim and at poles count as no narrower than this part of a mean pixel.
constexpr float least_side = 0.1F;
constexpr float rounding = 1e-6F; ///< of directions and places

/// Points of a rectangle of the picture, its part in the disk for round maps, by coordinates s and
/// t in [0, 1].
template <class Map>
class Patch {
public:
  /// Pixel (x, y) of a picture of width × height.
  /// @param frame axes of the directions in those of the picture; must outlive this
  Patch(int x, int y, int width, int height, const Frame& frame)
      : m_frame(frame), m_pixel(x, y, width, height), m_u0(edge(x, width)), m_v0(edge(y, height)),
        m_u1(edge(x + 1, width)), m_v1(edge(y + 1, height)) {
    if (!Map::round || !m_pixel.crosses_rim())
      return;
    m_at_rim = true;
    // Chords end on the rim head on where they follow the larger coordinate.
    m_swapped = std::abs(m_u0 + m_u1 - 1) > std::abs(m_v0 + m_v1 - 1);
    if (m_swapped)
      m_pixel = PixelRectangle(y, x, height, width);
  }

  bool is_empty() const { return m_at_rim && m_pixel.is_outside(); }

  Vec3 direction(float s, float t) const {
    Vec2 uv(m_u0 + s * (m_u1 - m_u0), m_v0 + t * (m_v1 - m_v0));
    if (m_at_rim)
      uv = point_at_rim(m_swapped ? t : s, m_swapped ? s : t);
    Vec3 w;
    Map::direction(uv.x(), uv.y(), w.x(), w.y(), w.z());
    return m_frame.to_local(w);
  }

private:
  static float edge(int i, int count) { return static_cast<float>(i) / static_cast<float>(count); }

  Vec2 point_at_rim(float s, float t) const {
    float from = 0;
    float to = 0;
    m_pixel.columns(from, to);
    const float a = from + s * (to - from);
    m_pixel.rows(a, from, to);
    // Near a mirror ball's rim directions go with the square root of the distance from it.
    if constexpr (std::is_same_v<Map, MirrorBallMap>)
      t = from + to > 0 ? t * (2 - t) : t * t;
    const float b = from + t * (to - from);
    const Vec2 uv(0.5F + 0.5F * a, 0.5F + 0.5F * b);
    return m_swapped ? Vec2(uv.y(), uv.x()) : uv;
  }

  const Frame& m_frame;
  PixelRectangle m_pixel;
  float m_u0, m_v0, m_u1, m_v1;
  bool m_at_rim = false;
  bool m_swapped = false;
};

/// The square about +z, or the same about −z: each is continuous in its own hemisphere and, but for
/// the seams x = 0 and y = 0, beyond.
class Chart {
public:
  /// @param centre direction in whose neighbourhood the chart will be used
  Chart(const Vec3& centre, int size) : m_centre(centre), m_below(centre.z() < 0), m_size(size) {}

  /// In pixels of the map.
  Vec2 place(Vec3 w) const {
    if (m_below)
      w.z() = -w.z();
    if (w.z() < 0) { // points on a seam belong to the side of the centre
      w.x() = on_own_side(w.x(), m_centre.x());
      w.y() = on_own_side(w.y(), m_centre.y());
    }
    return wavelet::sphere_to_square(w) * static_cast<float>(m_size);
  }

  /// The map's pixel that a pixel of the chart is.
  std::uint32_t index(int x, int y) const {
    if (m_below) { // |a| and |b| become 1 − |b| and 1 − |a|
      const int half = m_size / 2;
      const int from_middle_x = x >= half ? x - half : half - 1 - x;
      const int from_middle_y = y >= half ? y - half : half - 1 - y;
      x = x >= half ? m_size - 1 - from_middle_y : from_middle_y;
      y = y >= half ? m_size - 1 - from_middle_x : from_middle_x;
    }
    return static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(m_size) +
           static_cast<std::uint32_t>(x);
  }

private:
  static float on_own_side(float value, float centre) {
    return std::abs(value) < rounding ? std::copysign(value, centre) : value;
  }

  Vec3 m_centre;
  bool m_below;
  int m_size;
};

/// Divides one patch into cells and clips them.
template <class Map>
class PatchClipper {
public:
  /// @param tolerance deviation from straight edges, in map pixels
  PatchClipper(const Patch<Map>& patch, int size, float tolerance, AreaRaster& raster,
               std::vector<CoveredPixel>& out)
      : m_patch(patch), m_size(size), m_tolerance(tolerance), m_raster(raster), m_out(out) {}

  void clip(float s, float t, float extent, int halvings) {
    const float half = 0.5F * extent;
    const Vec3 centre = m_patch.direction(s + half, t + half);
    const Chart chart(centre, m_size);
    const auto place = [&](float i, float j) {
      return chart.place(m_patch.direction(s + i * half, t + j * half));
    };
    // Around the cell, corners at even places.
    const Outline outline = {place(0, 0), place(1, 0), place(2, 0), place(2, 1),
                             place(2, 2), place(1, 2), place(0, 2), place(0, 1)};
    if (halvings < most_halvings && !is_flat(outline, chart.place(centre))) {
      for (const Vec2& corner : {Vec2(0, 0), Vec2(half, 0), Vec2(0, half), Vec2(half, half)})
        clip(s + corner.x(), t + corner.y(), half, halvings + 1);
      return;
    }
    add(chart, outline);
  }

private:
  using Outline = std::array<Vec2, 8>;

  bool is_flat(const Outline& outline, const Vec2& centre) const {
    const auto is_middle = [&](const Vec2& middle, const Vec2& a, const Vec2& b) {
      return (middle - 0.5F * (a + b)).cwiseAbs().maxCoeff() <= m_tolerance;
    };
    for (std::size_t i = 0; i < 8; i += 2)
      if (!is_middle(outline[i + 1], outline[i], outline[(i + 2) % 8]))
        return false;
    return is_middle(centre, outline[0], outline[4]) && is_middle(centre, outline[2], outline[6]);
  }

  void add(const Chart& chart, const Outline& outline) {
    Vec2 low = outline[0];
    Vec2 high = outline[0];
    for (const Vec2& point : outline) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
    const auto pixel = [&](float value) {
      return std::clamp(static_cast<int>(value), 0, m_size - 1);
    };
    const int left = pixel(low.x());
    const int top = pixel(low.y());
    m_raster.reset(left, top, pixel(high.x()) - left + 1, pixel(high.y()) - top + 1);
    float turn = 0; // twice the signed area
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec2 from = outline[i] - low;
      const Vec2 to = outline[(i + 1) % 8] - low;
      turn += from.x() * to.y() - from.y() * to.x();
      m_raster.add_edge(outline[i], outline[(i + 1) % 8]);
    }
    // Along an edge downwards the raster adds, and the polygon lies to its right if it turns so.
    const float sign = turn > 0 ? -1.0F : 1.0F;
    m_raster.visit([&](int x, int y, float area) {
      if (sign * area > 0)
        m_out.push_back({chart.index(x, y), sign * area});
    });
  }

  const Patch<Map>& m_patch;
  int m_size;
  float m_tolerance;
  AreaRaster& m_raster;
  std::vector<CoveredPixel>& m_out;
};

} // namespace

void PixelCoverage::append(int x, int y, std::vector<CoveredPixel>& out) {
  const int columns = (least_cells + m_shape.width - 1) / m_shape.width;
  const int rows = (least_cells + m_shape.height - 1) / m_shape.height;
  with_mapping(m_shape.mapping, [&](auto map) {
    using Map = decltype(map);
    const float u = (static_cast<float>(x) + 0.5F) / static_cast<float>(m_shape.width);
    const float v = (static_cast<float>(y) + 0.5F) / static_cast<float>(m_shape.height);
    const float mean_side =
        static_cast<float>(m_size) /
        std::sqrt(static_cast<float>(m_shape.width) * static_cast<float>(m_shape.height));
    const float stretch = Map::density(u, v) / wavelet::sphere_area;
    const float side = mean_side * std::max(std::sqrt(stretch), least_side);
    const float tolerance = std::max(m_flatness * side, rounding * static_cast<float>(m_size));
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const Patch<Map> patch(x * columns + i, y * rows + j, m_shape.width * columns,
                               m_shape.height * rows, m_frame);
        if (!patch.is_empty())
          PatchClipper<Map>(patch, m_size, tolerance, m_raster, out).clip(0, 0, 1, 0);
      }
  });
}

} // namespace haarlight::probe
