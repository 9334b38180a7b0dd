#include <probe/light_distribution.h>

#include "pixel_shape.h"

#include <wavelet/error.h>
#include <wavelet/parallel.h>

#include <algorithm>
#include <numeric>

namespace haarlight::probe {
namespace {

/// What a pixel adds to the light: its luminance, or the mean of the interpolated one.
double pixel_luminance(const Probe& probe, int x, int y) {
  if (probe.lookup() == Lookup::Nearest)
    return luminance(probe.pixel(x, y));
  constexpr double weights[3] = {0.125, 0.75, 0.125};
  double sum = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      sum += weights[i + 1] * weights[j + 1] * luminance(probe.pixel(x + i, y + j));
  return sum;
}

} // namespace

LightDistribution::LightDistribution(const Probe& probe)
    : m_mapping(probe.mapping()), m_width(probe.width()), m_height(probe.height()),
      m_guides(std::max(1, probe.width() / 4)), m_rows(static_cast<std::size_t>(m_height) + 1),
      m_columns(static_cast<std::size_t>(m_height) * static_cast<std::size_t>(m_width + 1)),
      m_guide(static_cast<std::size_t>(m_height) * static_cast<std::size_t>(m_guides + 1)) {
  std::vector<double> rows(static_cast<std::size_t>(m_height));
  parallel_for(rows.size(), [&](std::size_t y) {
    std::vector<double> weights(static_cast<std::size_t>(m_width));
    for (int x = 0; x < m_width; ++x)
      weights[static_cast<std::size_t>(x)] = pixel_luminance(probe, x, static_cast<int>(y)) *
                                             probe.pixel_solid_angle(x, static_cast<int>(y));
    std::uint32_t* cdf = m_columns.data() + y * static_cast<std::size_t>(m_width + 1);
    accumulate(weights, cdf);
    make_guide(cdf, m_guide.data() + y * static_cast<std::size_t>(m_guides + 1));
    rows[y] = std::accumulate(weights.begin(), weights.end(), 0.0);
  });
  if (std::accumulate(rows.begin(), rows.end(), 0.0) <= 0)
    throw_input_error(probe.path(), "is black, a probe must shine somewhere");
  accumulate(rows, m_rows.data());
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

void LightDistribution::make_guide(const std::uint32_t* cdf, std::uint32_t* guide) const {
  const std::uint32_t* at = cdf;
  for (int k = 0; k < m_guides; ++k) {
    const auto from = static_cast<std::uint32_t>(
        std::uint64_t{one} * static_cast<std::uint64_t>(k) / static_cast<std::uint64_t>(m_guides));
    at = std::upper_bound(at, cdf + m_width + 1, from);
    at = at == cdf ? at : at - 1;
    guide[k] = static_cast<std::uint32_t>(at - cdf);
  }
  guide[m_guides] = static_cast<std::uint32_t>(m_width);
}

/// The step of the cdf that u falls in, sought where begin ≤ it < end.
LightDistribution::Step LightDistribution::find(const std::uint32_t* begin,
                                                const std::uint32_t* end, const std::uint32_t* cdf,
                                                double u) {
  const double place = u * one;
  const auto whole = std::min(static_cast<std::uint32_t>(place), one - 1);
  const std::uint32_t* step = std::upper_bound(begin, end, whole) - 1;
  const std::uint32_t width = step[1] - step[0];
  const double fraction = (place - step[0]) / width;
  return {static_cast<int>(step - cdf), width,
          std::clamp(static_cast<float>(fraction), 0.0F, 0x1.fffffep-1F)};
}

LightDistribution::Step LightDistribution::find_column(int row, float u) const {
  const auto y = static_cast<std::size_t>(row);
  const std::uint32_t* cdf = m_columns.data() + y * static_cast<std::size_t>(m_width + 1);
  const std::uint32_t* guide = m_guide.data() + y * static_cast<std::size_t>(m_guides + 1);
  const auto whole = std::min(static_cast<std::uint32_t>(static_cast<double>(u) * one), one - 1);
  const auto part = (std::uint64_t{whole} * static_cast<std::uint64_t>(m_guides)) >> 31U;
  const std::uint32_t* begin = cdf + guide[part];
  const std::uint32_t* end = cdf + std::min<std::uint32_t>(guide[part + 1] + 1, m_width);
  return find(begin, std::max(end, begin + 1), cdf, u);
}

Vec2 LightDistribution::point_in_pixel(int x, int y, const Vec2& u, float& area) const {
  const Vec2 size(static_cast<float>(m_width), static_cast<float>(m_height));
  area = 1.0F / (size.x() * size.y());
  if (is_round(m_mapping)) {
    const PixelRectangle pixel(x, y, m_width, m_height);
    if (pixel.crosses_rim()) {
      float a_from = 0;
      float a_to = 0;
      float b_from = 0;
      float b_to = 0;
      pixel.columns(a_from, a_to);
      const float a = a_from + u.x() * (a_to - a_from);
      pixel.rows(a, b_from, b_to);
      area = 0.25F * (a_to - a_from) * (b_to - b_from);
      return {0.5F + 0.5F * a, 0.5F + 0.5F * (b_from + u.y() * (b_to - b_from))};
    }
  }
  return (Vec2(static_cast<float>(x), static_cast<float>(y)) + u).cwiseQuotient(size);
}

/// The area in (u, v) that stands for a pixel's density at a point in it.
float LightDistribution::pixel_area(int x, int y, const Vec2& uv) const {
  const PixelRectangle pixel(x, y, m_width, m_height);
  if (!is_round(m_mapping) || !pixel.crosses_rim())
    return 1.0F / (static_cast<float>(m_width) * static_cast<float>(m_height));
  float a_from = 0;
  float a_to = 0;
  float b_from = 0;
  float b_to = 0;
  pixel.columns(a_from, a_to);
  pixel.rows(2.0F * uv.x() - 1.0F, b_from, b_to);
  return 0.25F * (a_to - a_from) * (b_to - b_from);
}

float LightDistribution::density(std::uint32_t row_width, std::uint32_t column_width, float area,
                                 const Vec2& uv) const {
  constexpr float unit = 1.0F / static_cast<float>(one);
  const float probability =
      static_cast<float>(row_width) * unit * (static_cast<float>(column_width) * unit);
  return probability / (std::max(area, 1e-20F) * solid_angle_density(m_mapping, uv));
}

LightSample LightDistribution::sample(const Vec2& u) const {
  const Step row = find(m_rows.data(), m_rows.data() + m_height, m_rows.data(), u.y());
  const Step column = find_column(row.index, u.x());
  float area = 0;
  const Vec2 uv = point_in_pixel(column.index, row.index, {column.fraction, row.fraction}, area);
  return {image_to_direction(m_mapping, uv), density(row.width, column.width, area, uv)};
}

float LightDistribution::pdf(const Vec3& w) const {
  const Vec2 uv = direction_to_image(m_mapping, w);
  const int x = std::min(static_cast<int>(uv.x() * static_cast<float>(m_width)), m_width - 1);
  const int y = std::min(static_cast<int>(uv.y() * static_cast<float>(m_height)), m_height - 1);
  const auto row = static_cast<std::size_t>(y);
  const std::uint32_t* cdf =
      m_columns.data() + row * static_cast<std::size_t>(m_width + 1) + static_cast<std::size_t>(x);
  return density(m_rows[row + 1] - m_rows[row], cdf[1] - cdf[0], pixel_area(x, y, uv), uv);
}

} // namespace haarlight::probe
