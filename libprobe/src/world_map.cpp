#include <probe/probe_maps.h>

#include "mapping_lanes.h"
#include "peaks.h"
#include "point_kernels.h"

#include <wavelet/parallel.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>

namespace haarlight::probe {
namespace {

/// Samples that a probe pixel gets at least, where the sampling of map pixels can be chosen so.
constexpr float samples_per_texel = 64;
constexpr int most_samples_along = 64;

Float4 load(const float* values) {
  Float4 result;
  __builtin_memcpy(&result, values, sizeof result);
  return result;
}

/// Averages the base over the squares of a map.
template <class Map>
class Gatherer {
public:
  Gatherer(const Probe& probe, const std::vector<float>& base, int size, int supersample)
      : m_base(base), m_shape{probe.mapping(), probe.width(), probe.height()},
        m_size(static_cast<float>(size)), m_supersample(supersample) {}

  Rgb average(int x, int y) const {
    std::array<std::int32_t, most_samples_along * most_samples_along> texels;
    const PointGrid points = grid_in(x, y);
    find_texels(m_shape, points, texels.data());
    const int count = points.columns * points.rows;
    const Float4 sum = sum_of(std::span(texels).first(static_cast<std::size_t>(count)));
    return Rgb(sum[0], sum[1], sum[2]) / static_cast<float>(count);
  }

private:
  /// About as many points along each side of the pixel, so that both its samples and those of the
  /// probe's pixels there are enough.
  PointGrid grid_in(int x, int y) const {
    const float along = samples_along(x, y);
    const int steps = std::max(1, static_cast<int>(std::lround(along / point_step)));
    PointGrid grid;
    grid.columns = steps * point_step;
    const int needed =
        static_cast<int>(std::ceil(along * along / static_cast<float>(grid.columns)));
    grid.rows = std::max(needed, grid.columns / 2);
    grid.step_u = 1.0F / (static_cast<float>(grid.columns) * m_size);
    grid.step_v = 1.0F / (static_cast<float>(grid.rows) * m_size);
    grid.first_u = static_cast<float>(x) / m_size + 0.5F * grid.step_u;
    grid.first_v = static_cast<float>(y) / m_size + 0.5F * grid.step_v;
    return grid;
  }

  float samples_along(int x, int y) const {
    const Vec2 square((static_cast<float>(x) + 0.5F) / m_size,
                      (static_cast<float>(y) + 0.5F) / m_size);
    const Vec3 w = wavelet::square_to_sphere(square);
    Vec2 uv;
    Map::image(w.x(), w.y(), w.z(), uv.x(), uv.y());
    const float texels = static_cast<float>(m_shape.width) * static_cast<float>(m_shape.height);
    const float texel = Map::density(uv.x(), uv.y()) / texels;
    const float pixel = wavelet::sphere_area / (m_size * m_size);
    const float wanted = std::sqrt(samples_per_texel * pixel / texel);
    return std::clamp(wanted, static_cast<float>(m_supersample),
                      static_cast<float>(most_samples_along));
  }

  /// Summed by eight, so that rounding errors stay small.
  Float4 sum_of(std::span<const std::int32_t> texels) const {
    Float4 sum = {};
    for (std::size_t i = 0; i < texels.size(); i += 8) {
      Float4 even = {};
      Float4 odd = {};
      for (std::size_t k = i; k < i + 8; k += 2) {
        even += load(m_base.data() + 4 * static_cast<std::size_t>(texels[k]));
        odd += load(m_base.data() + 4 * static_cast<std::size_t>(texels[k + 1]));
      }
      sum += even + odd;
    }
    return sum;
  }

  const std::vector<float>& m_base;
  PictureShape m_shape;
  float m_size;
  int m_supersample;
};

/// Spreads a peak's energy over the map: a grid of points in its part of the map, each with its
/// share of the solid angle.
template <class Map>
class Spreader {
public:
  Spreader(const Probe& probe, wavelet::Map& map)
      : m_probe(probe), m_map(map), m_size(static_cast<float>(map.size)) {}

  void spread(const Peak& peak) {
    m_points.clear();
    const double whole = m_probe.pixel_solid_angle(peak.x, peak.y);
    const double pixel = wavelet::sphere_area / m_size / m_size;
    const int along = std::clamp(4 * static_cast<int>(std::ceil(std::sqrt(whole / pixel))), 8, 32);
    const float total = add_points(peak, along);
    if (!(total > 0))
      return;
    const Rgb share = peak.excess * static_cast<float>(whole / pixel / total);
    for (const auto& [offset, weight] : m_points)
      Eigen::Map<Rgb>(m_map.rgb.data() + offset) += share * weight;
  }

private:
  struct Point {
    std::size_t offset;
    float weight;
  };

  float add_points(const Peak& peak, int along) {
    float total = 0;
    const float step = 1.0F / static_cast<float>(along);
    for (int j = 0; j < along; ++j)
      for (int i = 0; i < along; ++i) {
        const Vec2 in_pixel((static_cast<float>(i) + 0.5F) * step,
                            (static_cast<float>(j) + 0.5F) * step);
        total += add_point(
            (static_cast<float>(peak.x) + in_pixel.x()) / static_cast<float>(m_probe.width()),
            (static_cast<float>(peak.y) + in_pixel.y()) / static_cast<float>(m_probe.height()));
      }
    return total;
  }

  float add_point(float u, float v) {
    if (Map::round && radius_squared({u, v}) > 1.0F)
      return 0;
    Vec3 w;
    Map::direction(u, v, w.x(), w.y(), w.z());
    const Vec2 square = wavelet::sphere_to_square(w) * m_size;
    const int last = m_map.size - 1;
    const float weight = Map::density(u, v);
    m_points.push_back({m_map.offset(std::min(static_cast<int>(square.x()), last),
                                     std::min(static_cast<int>(square.y()), last)),
                        weight});
    return weight;
  }

  const Probe& m_probe;
  wavelet::Map& m_map;
  float m_size;
  std::vector<Point> m_points;
};

} // namespace

wavelet::Map world_map(const Probe& probe, int size, int supersample) {
  assert(size >= 4 && supersample >= 1 && supersample <= most_samples_along);
  const SplitProbe split = split_peaks(probe);
  wavelet::Map map(size);
  with_mapping(probe.mapping(), [&](auto mapping) {
    const Gatherer<decltype(mapping)> gatherer(probe, split.base, size, supersample);
    parallel_for(static_cast<std::size_t>(size), [&](std::size_t y) {
      for (int x = 0; x < size; ++x)
        map.set(x, static_cast<int>(y), gatherer.average(x, static_cast<int>(y)));
    });
    Spreader<decltype(mapping)> spreader(probe, map);
    for (const Peak& peak : split.peaks)
      spreader.spread(peak);
  });
  return map;
}

} // namespace haarlight::probe
