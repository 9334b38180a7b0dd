#include "maps/area_sum.h"

#include "mapping/mapping_lanes.h"
#include "maps/pixel_shape.h"

#include <wavelet/base/parallel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

namespace haarlight::probe {

// Peaks.

namespace {

constexpr int reach = 2;
constexpr int neighbours = (2 * reach + 1) * (2 * reach + 1) - 1;

/// Luminance of the pixels whose centre is in the map, black around them: pixels beyond the map may
/// be copies of one within.
class OwnLuminance {
public:
  explicit OwnLuminance(const Probe& probe)
      : m_width(probe.width() + 2 * reach),
        m_value(static_cast<std::size_t>(m_width) *
                static_cast<std::size_t>(probe.height() + 2 * reach)) {
    parallel_for(static_cast<std::size_t>(probe.height()), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < probe.width(); ++x)
        if (probe.owns(x, y))
          m_value[index(x, y)] = luminance(probe.pixel(x, y));
    });
  }

  float at(int x, int y) const { return m_value[index(x, y)]; }

  double sum_around(int x, int y) const {
    double sum = 0;
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i)
        sum += i == 0 && j == 0 ? 0.0 : at(x + i, y + j);
    return sum;
  }

private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + reach) * static_cast<std::size_t>(m_width) +
           static_cast<std::size_t>(x + reach);
  }

  int m_width;
  std::vector<float> m_value;
};

bool is_peak(const Probe& probe, const OwnLuminance& own, int x, int y, double contrast) {
  const double value = luminance(probe.pixel(x, y));
  double around = own.sum_around(x, y);
  if (!probe.owns(x, y)) // a copy of one of those around, which must not justify it
    around = std::max(0.0, around - value);
  return value > around * (contrast / neighbours);
}

} // namespace

std::vector<PixelPlace> find_peaks(const Probe& probe, double contrast) {
  const OwnLuminance own(probe);
  std::vector<std::vector<PixelPlace>> rows(static_cast<std::size_t>(probe.height()));
  parallel_for(rows.size(), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < probe.width(); ++x)
      if (is_peak(probe, own, x, y, contrast))
        rows[row].push_back({x, y});
  });
  std::vector<PixelPlace> all;
  for (const auto& row : rows)
    all.insert(all.end(), row.begin(), row.end());
  return all;
}

float radiance_unit(const Probe& probe) {
  float largest = 0;
  for (int y = 0; y < probe.height(); ++y)
    for (int x = 0; x < probe.width(); ++x)
      largest = std::max(largest, probe.pixel(x, y).maxCoeff());
  return largest > 0x1p96F ? 0x1p32F : 1.0F;
}

// Areas of polygons.

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
    // The part of the edge left of this pixel covers it fully, the part within it partly.
    const float whole = per_pixel * std::max(static_cast<float>(column) - left, 0.0F);
    const float area = whole + per_pixel * (to - from) * (1.0F - 0.5F * (from + to));
    steps[column] += area - before;
    before = area;
  }
  steps[last + 1] += height - before;
}

// Projection of pixels.

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
    float doubled = 0; // twice the signed area
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec2 from = outline[i] - low;
      const Vec2 to = outline[(i + 1) % 8] - low;
      doubled += from.x() * to.y() - from.y() * to.x();
      m_raster.add_edge(outline[i], outline[(i + 1) % 8]);
    }
    // Along an edge downwards the raster adds, and the polygon lies to its right if it is oriented
    // so.
    const float sign = doubled > 0 ? -1.0F : 1.0F;
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

// Sums.

/// The map pixels that a few source pixels cover.
struct AreaSum::Group {
  std::vector<CoveredPixel> covered;
  std::vector<std::size_t> ends; ///< in covered, of each source pixel

  void clip(PixelCoverage coverage, std::span<const SourcePixel> pixels) {
    covered.clear();
    ends.clear();
    for (const SourcePixel& pixel : pixels) {
      coverage.append(pixel.x, pixel.y, covered);
      ends.push_back(covered.size());
    }
  }
};

AreaSum::AreaSum(int size)
    : m_size(size), m_rgb(3 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size)),
      m_covered(m_rgb.size() / 3) {}

void AreaSum::add(const PixelCoverage& coverage, std::span<const SourcePixel> pixels) {
  constexpr std::size_t batch = 4096;
  constexpr std::size_t group_size = 64;
  std::vector<Group> groups(std::min(batch / group_size, pixels.size() / group_size + 1));
  for (std::size_t begin = 0; begin < pixels.size(); begin += batch) {
    const auto part = pixels.subspan(begin, std::min(batch, pixels.size() - begin));
    parallel_for((part.size() + group_size - 1) / group_size, [&](std::size_t g) {
      const std::size_t from = g * group_size;
      groups[g].clip(coverage, part.subspan(from, std::min(group_size, part.size() - from)));
    });
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Group& group = groups[i / group_size];
      const std::size_t k = i % group_size;
      const std::size_t from = k == 0 ? 0 : group.ends[k - 1];
      add_covered(part[i].radiance, std::span(group.covered).subspan(from, group.ends[k] - from));
    }
  }
}

void AreaSum::add_covered(const Rgb& radiance, std::span<const CoveredPixel> covered) {
  for (const CoveredPixel& pixel : covered) {
    Eigen::Map<Rgb>(m_rgb.data() + 3 * std::size_t{pixel.index}) += pixel.fraction * radiance;
    m_covered[pixel.index] += pixel.fraction;
  }
}

Rgb AreaSum::mean(int x, int y, const Rgb& others, float layers) const {
  const std::size_t i = index(x, y);
  const float rest = std::max(0.0F, layers - m_covered[i]);
  const Rgb sum = Eigen::Map<const Rgb>(m_rgb.data() + 3 * i);
  return (sum + rest * others) / (m_covered[i] + rest);
}

Rgb AreaSum::covered_mean(int x, int y) const {
  const std::size_t i = index(x, y);
  const Rgb sum = Eigen::Map<const Rgb>(m_rgb.data() + 3 * i);
  return m_covered[i] > 0 ? Rgb(sum / m_covered[i]) : Rgb::Zero();
}

} // namespace haarlight::probe
