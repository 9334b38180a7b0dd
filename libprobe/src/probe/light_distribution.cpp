#include <probe/light_distribution.h>

#include "mapping/mapping_lanes.h"
#include "maps/pixel_shape.h"

#include <wavelet/base/parallel.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace haarlight::probe {
namespace {

/// Whether nothing of the probe that counts has radiance.
bool is_black(const Probe& probe) {
  for (int y = 0; y < probe.height(); ++y)
    for (int x = 0; x < probe.width(); ++x)
      if (probe.mean_luminance(x, y) > 0 && probe.pixel_solid_angle(x, y) > 0)
        return false;
  return true;
}

} // namespace

LightDistribution::LightDistribution(const Probe& probe)
    : m_mapping(probe.mapping()), m_width(probe.width()), m_height(probe.height()),
      m_rows(static_cast<std::size_t>(m_height) + 1),
      m_row_guide(row_parts * static_cast<std::size_t>(m_height)),
      m_columns(static_cast<std::size_t>(m_height) * static_cast<std::size_t>(m_width + 1)),
      m_column_parts((m_width + 3) / 4), m_column_guide(static_cast<std::size_t>(m_height) *
                                                        static_cast<std::size_t>(m_column_parts)) {
  const auto width = static_cast<std::size_t>(m_width);
  std::vector<double> rows(static_cast<std::size_t>(m_height));
  const bool black = is_black(probe);
  parallel_for(rows.size(), [&](std::size_t y) {
    std::vector<double> weights(width);
    for (int x = 0; x < m_width; ++x) {
      const double radiance = black ? 1.0 : probe.mean_luminance(x, static_cast<int>(y));
      weights[static_cast<std::size_t>(x)] =
          radiance * probe.pixel_solid_angle(x, static_cast<int>(y));
    }
    std::uint32_t* cdf = m_columns.data() + y * (width + 1);
    accumulate(weights, cdf);
    make_guide(cdf, m_column_parts,
               m_column_guide.data() + y * static_cast<std::size_t>(m_column_parts));
    rows[y] = std::accumulate(weights.begin(), weights.end(), 0.0);
  });
  accumulate(rows, m_rows.data());
  make_guide(m_rows.data(), row_parts * m_height, m_row_guide.data());
}

/// Every positive weight gets one unit at least, a weight of 0 none.
void LightDistribution::accumulate(const std::vector<double>& weights, std::uint32_t* cdf) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  const auto positive = static_cast<double>(
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; }));
  const double scale = total > 0 ? (one - positive) / total : 0;
  double sum = 0;
  double units = 0;
  cdf[0] = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    units += weights[i] > 0 ? 1 : 0;
    cdf[i + 1] =
        units < positive ? std::min(static_cast<std::uint32_t>(sum * scale + units), one - 1) : one;
  }
}

/// Of `parts` equal parts of the whole, the steps of the cdf that they begin in.
void LightDistribution::make_guide(const std::uint32_t* cdf, int parts, std::uint32_t* guide) {
  std::uint32_t step = 0;
  for (int k = 0; k < parts; ++k) {
    const auto from = static_cast<std::uint64_t>(one) * static_cast<std::uint64_t>(k) /
                      static_cast<std::uint64_t>(parts);
    while (cdf[step + 1] <= from)
      ++step;
    guide[k] = step;
  }
}

/// The step of the cdf that u falls in: on average a few steps from the one in the guide.
LightDistribution::Step LightDistribution::find(const std::uint32_t* cdf,
                                                const std::uint32_t* guide, int parts, float u) {
  constexpr std::int64_t last = std::int64_t{one} - 1;
  const auto place = static_cast<std::uint32_t>(
      std::min(static_cast<std::int64_t>(u * static_cast<float>(one)), last));
  std::uint32_t step = guide[(std::uint64_t{place} * static_cast<std::uint64_t>(parts)) >> 31U];
  while (cdf[step + 1] <= place)
    ++step;
  const std::uint32_t width = cdf[step + 1] - cdf[step];
  const float fraction = (static_cast<float>(place - cdf[step]) + 0.5F) / static_cast<float>(width);
  return {static_cast<int>(step), width, std::min(fraction, 0x1.fffffep-1F)};
}

/// The point of a pixel at the two fractions, and the area in which it is uniform.
LightDistribution::Place LightDistribution::place_in_pixel(const Step& column,
                                                           const Step& row) const {
  if (is_round(m_mapping)) {
    const PixelRectangle pixel(column.index, row.index, m_width, m_height);
    if (pixel.crosses_rim())
      return place_at_rim(pixel, column.fraction, row.fraction);
  }
  const float across = 1.0F / static_cast<float>(m_width);
  const float down = 1.0F / static_cast<float>(m_height);
  return {(static_cast<float>(column.index) + column.fraction) * across,
          (static_cast<float>(row.index) + row.fraction) * down, across * down};
}

LightDistribution::Place LightDistribution::place_at_rim(const PixelRectangle& pixel, float s,
                                                         float t) {
  float a_from = 0;
  float a_to = 0;
  float b_from = 0;
  float b_to = 0;
  pixel.columns(a_from, a_to);
  const float a = a_from + s * (a_to - a_from);
  pixel.rows(a, b_from, b_to);
  const float b = b_from + t * (b_to - b_from);
  return {0.5F + 0.5F * a, 0.5F + 0.5F * b, 0.25F * (a_to - a_from) * (b_to - b_from)};
}

/// The area in (u, v) that a pixel's probability is spread over, as it counts at a place in it.
float LightDistribution::pixel_area(int x, int y, float u) const {
  const PixelRectangle pixel(x, y, m_width, m_height);
  if (!is_round(m_mapping) || !pixel.crosses_rim())
    return 1.0F / static_cast<float>(m_width) * (1.0F / static_cast<float>(m_height));
  float a_from = 0;
  float a_to = 0;
  float b_from = 0;
  float b_to = 0;
  pixel.columns(a_from, a_to);
  pixel.rows(2.0F * u - 1.0F, b_from, b_to);
  return 0.25F * (a_to - a_from) * (b_to - b_from);
}

/// @param solid_angle over which the pixel's probability is spread, by the density at the point
float LightDistribution::density(std::uint32_t row_width, std::uint32_t column_width,
                                 float solid_angle) {
  constexpr float unit = 1.0F / static_cast<float>(one);
  const float probability =
      (static_cast<float>(row_width) * unit) * (static_cast<float>(column_width) * unit);
  return probability / std::max(solid_angle, 1e-30F);
}

LightDistribution::Step LightDistribution::find_row(float u) const {
  return find(m_rows.data(), m_row_guide.data(), row_parts * m_height, u);
}

LightDistribution::Step LightDistribution::find_column(const Step& row, float u) const {
  const auto y = static_cast<std::size_t>(row.index);
  return find(m_columns.data() + y * static_cast<std::size_t>(m_width + 1),
              m_column_guide.data() + y * static_cast<std::size_t>(m_column_parts), m_column_parts,
              u);
}

LightSample LightDistribution::sample(const Vec2& u) const {
  LightSample result;
  sample(std::span(&u, 1), std::span(&result, 1));
  return result;
}

void LightDistribution::sample(std::span<const Vec2> points, std::span<LightSample> out) const {
  constexpr std::size_t batch = 64;
  std::array<Step, batch> rows;
  std::array<Step, batch> columns;
  for (std::size_t begin = 0; begin < points.size(); begin += batch) {
    const std::size_t count = std::min(batch, points.size() - begin);
    for (std::size_t i = 0; i < count; ++i)
      rows[i] = find_row(points[begin + i].y());
    for (std::size_t i = 0; i < count; ++i)
      columns[i] = find_column(rows[i], points[begin + i].x());
    finish(std::span(rows).first(count), std::span(columns).first(count),
           out.subspan(begin, count));
  }
}

void LightDistribution::sample_in(std::span<const PixelPoint> points,
                                  std::span<LightSample> out) const {
  constexpr std::size_t batch = 64;
  std::array<Step, batch> rows;
  std::array<Step, batch> columns;
  for (std::size_t begin = 0; begin < points.size(); begin += batch) {
    const std::size_t count = std::min(batch, points.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const PixelPoint& point = points[begin + i];
      rows[i] = step_of_row(point.y);
      rows[i].fraction = point.fraction.y();
      columns[i] = step_of_column(point.x, point.y);
      columns[i].fraction = point.fraction.x();
    }
    finish(std::span(rows).first(count), std::span(columns).first(count),
           out.subspan(begin, count));
  }
}

/// The samples at places that both steps of each are known of.
void LightDistribution::finish(std::span<const Step> rows, std::span<const Step> columns,
                               std::span<LightSample> out) const {
  with_mapping(m_mapping, [&](auto map) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Place place = place_in_pixel(columns[i], rows[i]);
      LightSample& s = out[i];
      float stretch = 0;
      map.direction_and_density(place.u, place.v, s.direction.x(), s.direction.y(), s.direction.z(),
                                stretch);
      s.pdf = density(rows[i].width, columns[i].width, place.area * stretch);
    }
  });
}

LightDistribution::Step LightDistribution::step_of_row(int y) const {
  const auto row = static_cast<std::size_t>(y);
  return {y, m_rows[row + 1] - m_rows[row], 0};
}

LightDistribution::Step LightDistribution::step_of_column(int x, int y) const {
  const std::uint32_t* cdf = m_columns.data() +
                             static_cast<std::size_t>(y) * static_cast<std::size_t>(m_width + 1) +
                             static_cast<std::size_t>(x);
  return {x, cdf[1] - cdf[0], 0};
}

double LightDistribution::probability(int x, int y) const {
  constexpr double unit = 1.0 / one;
  return (step_of_row(y).width * unit) * (step_of_column(x, y).width * unit);
}

float LightDistribution::pdf(const Vec3& w) const {
  const Vec2 uv = direction_to_image(m_mapping, w);
  const int x = std::min(static_cast<int>(uv.x() * static_cast<float>(m_width)), m_width - 1);
  const int y = std::min(static_cast<int>(uv.y() * static_cast<float>(m_height)), m_height - 1);
  return density(step_of_row(y).width, step_of_column(x, y).width,
                 pixel_area(x, y, uv.x()) * solid_angle_density(m_mapping, uv));
}

} // namespace haarlight::probe
