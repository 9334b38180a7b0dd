#include <probe/probe_maps.h>

#include "mapping_lanes.h"
#include "point_kernels.h"

#include <wavelet/parallel.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace haarlight::probe {
namespace {

/// Samples that a probe pixel gets at least, where the sampling of map pixels can be chosen so.
constexpr float samples_per_texel = 64;
constexpr int most_samples_along = 64;

/// A probe pixel whose excess over its neighbours is spread by area instead of being sampled.
struct Peak {
  int x = 0;
  int y = 0;
  Rgb excess;
};

/// The probe without its peaks, four floats for each pixel, and the peaks.
struct Split {
  std::vector<float> base;
  std::vector<Peak> peaks;
};

bool is_own_pixel(const Probe& probe, int x, int y) {
  if (x < 0 || y < 0 || x >= probe.width() || y >= probe.height())
    return false;
  const Vec2 centre((static_cast<float>(x) + 0.5F) / static_cast<float>(probe.width()),
                    (static_cast<float>(y) + 0.5F) / static_cast<float>(probe.height()));
  return in_map(probe.mapping(), centre);
}

/// Of the eight around a pixel; what lies beyond the map, perhaps a copy of the pixel itself,
/// counts as black.
Rgb mean_of_neighbours(const Probe& probe, int x, int y) {
  Rgb sum(0, 0, 0);
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      if ((i != 0 || j != 0) && is_own_pixel(probe, x + i, y + j))
        sum += probe.pixel(x + i, y + j);
  return sum / 8;
}

/// Base: no more than four times the luminance of the eight neighbours' mean.
Split split_row(const Probe& probe, int y) {
  Split row;
  row.base.resize(4 * static_cast<std::size_t>(probe.width()));
  for (int x = 0; x < probe.width(); ++x) {
    const Rgb value = probe.pixel(x, y);
    const float limit = 4 * luminance(mean_of_neighbours(probe, x, y));
    const float own = luminance(value);
    const float kept = own > limit ? limit / own : 1.0F;
    Eigen::Map<Rgb>(row.base.data() + 4 * static_cast<std::size_t>(x)) = kept * value;
    if (kept < 1)
      row.peaks.push_back({x, y, (1 - kept) * value});
  }
  return row;
}

Split split_peaks(const Probe& probe) {
  std::vector<Split> rows(static_cast<std::size_t>(probe.height()));
  parallel_for(rows.size(),
               [&](std::size_t y) { rows[y] = split_row(probe, static_cast<int>(y)); });
  Split all;
  all.base.reserve(rows.size() * 4 * static_cast<std::size_t>(probe.width()));
  for (auto& row : rows) {
    all.base.insert(all.base.end(), row.base.begin(), row.base.end());
    all.peaks.insert(all.peaks.end(), row.peaks.begin(), row.peaks.end());
    row = {};
  }
  return all;
}

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
    const int along = samples_along(x, y);
    const float step = 1.0F / (static_cast<float>(along) * m_size);
    PointRow points;
    points.first_u = static_cast<float>(x) / m_size + 0.5F * step;
    points.step = step;
    points.count = along;
    Float4 sum = {};
    for (int j = 0; j < along; ++j) {
      points.v = static_cast<float>(y) / m_size + (static_cast<float>(j) + 0.5F) * step;
      sum += sum_of_row(points);
    }
    return Rgb(sum[0], sum[1], sum[2]) / static_cast<float>(along * along);
  }

private:
  /// A multiple of point_step.
  int samples_along(int x, int y) const {
    const Vec2 square((static_cast<float>(x) + 0.5F) / m_size,
                      (static_cast<float>(y) + 0.5F) / m_size);
    const Vec3 w = wavelet::square_to_sphere(square);
    Vec2 uv;
    Map::image(w.x(), w.y(), w.z(), uv.x(), uv.y());
    const float texels = static_cast<float>(m_shape.width) * static_cast<float>(m_shape.height);
    const float texel = Map::density(uv.x(), uv.y()) / texels;
    const float pixel = wavelet::sphere_area / (m_size * m_size);
    const float wanted = std::min(std::sqrt(samples_per_texel * pixel / texel),
                                  static_cast<float>(most_samples_along));
    const int along = std::max(m_supersample, static_cast<int>(std::ceil(wanted)));
    return (along + point_step - 1) / point_step * point_step;
  }

  Float4 sum_of_row(const PointRow& points) const {
    std::array<std::int32_t, point_step> texels;
    PointRow part = points;
    part.count = point_step;
    Float4 even = {};
    Float4 odd = {};
    for (int i = 0; i < points.count; i += point_step) {
      part.first_u = points.first_u + static_cast<float>(i) * points.step;
      find_texels(m_shape, part, texels.data());
      for (std::size_t k = 0; k < texels.size(); k += 2) {
        even += load(m_base.data() + 4 * static_cast<std::size_t>(texels[k]));
        odd += load(m_base.data() + 4 * static_cast<std::size_t>(texels[k + 1]));
      }
    }
    return even + odd;
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
  assert(size >= 4 && supersample >= 1);
  const Split split = split_peaks(probe);
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
