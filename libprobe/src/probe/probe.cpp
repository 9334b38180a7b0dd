#include <probe/probe.h>

#include "mapping/mapping_lanes.h"
#include "maps/pixel_shape.h"

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace haarlight::probe {
namespace {

void check_shape(const Image& image, Mapping mapping, const std::string& path) {
  if (mapping != Mapping::LatLong && image.width != image.height)
    throw_input_error(path, "is " + std::to_string(image.width) + " × " +
                                std::to_string(image.height) + " pixels, a probe of mapping " +
                                mapping_name(mapping) + " must be square");
}

/// Solid angle between two rows of a latlong map, exact, for one of its columns.
double latlong_pixel(int y, int width, int height) {
  const float step = pi / static_cast<float>(height);
  const auto rows_from_pole = static_cast<float>(std::min(y, height - 1 - y));
  float middle = 0;
  float half = 0;
  float cosine = 0;
  sine_cosine((rows_from_pole + 0.5F) * step, middle, cosine);
  sine_cosine(0.5F * step, half, cosine);
  return 4.0 * pi / width * middle * half;
}

constexpr float gauss = 0.28867513F; ///< of two points, from the middle of an interval of length 1

/// Gauss quadrature of the density over a pixel that lies wholly in the map, of 2 × 2 points, and
/// of 2 × 2 in each part of the pixels of small pictures.
template <class Map>
double whole_pixel(Map map, int x, int y, int width, int height) {
  constexpr int least_width = 16;
  const int parts = (least_width + width - 1) / width;
  const auto along = static_cast<float>(parts);
  double sum = 0;
  for (int j = 0; j < parts; ++j)
    for (int i = 0; i < parts; ++i) {
      const float column = static_cast<float>(x * parts + i) + 0.5F;
      const float row = static_cast<float>(y * parts + j) + 0.5F;
      const Float4 u =
          (column + Float4{-gauss, gauss, -gauss, gauss}) / (along * static_cast<float>(width));
      const Float4 v =
          (row + Float4{-gauss, -gauss, gauss, gauss}) / (along * static_cast<float>(height));
      const Float4 d = map.density(u, v);
      sum += static_cast<double>(d[0]) + d[1] + d[2] + d[3];
    }
  return 0.25 * sum / (parts * parts) / width / height;
}

/// Strips across a pixel of the rim, each of the length that lies inside, for a in [from, to]. That
/// length may go with the square root of the distance from either end, so that a is substituted by
/// a cubic that is flat at both.
template <class Map>
double rim_strips(Map map, const PixelRectangle& pixel, float from, float to) {
  constexpr int strips = 12;
  const auto place = [](int i, float point) { return (static_cast<float>(i) + point) / strips; };
  double sum = 0;
  for (int i = 0; i < strips; ++i)
    for (const float point_a : {0.5F - gauss, 0.5F + gauss}) {
      const float t = place(i, point_a);
      const float a = from + (to - from) * t * t * (3 - 2 * t);
      float b_from = 0;
      float b_to = 0;
      pixel.rows(a, b_from, b_to);
      double strip = 0;
      for (int j = 0; j < strips; ++j)
        for (const float point_b : {0.5F - gauss, 0.5F + gauss}) {
          const float b = b_from + (b_to - b_from) * place(j, point_b);
          strip += static_cast<double>(map.density(0.5F + 0.5F * a, 0.5F + 0.5F * b));
        }
      sum += strip * (b_to - b_from) * (6 * t * (1 - t));
    }
  return 0.25 * sum * (to - from) / (4 * strips * strips);
}

/// A pixel the rim runs through, divided where the rim meets its edges.
template <class Map>
double rim_pixel(Map map, const PixelRectangle& pixel) {
  float from = 0;
  float to = 0;
  pixel.columns(from, to);
  const float corner0 = std::sqrt(std::max(0.0F, 1 - pixel.b0 * pixel.b0));
  const float corner1 = std::sqrt(std::max(0.0F, 1 - pixel.b1 * pixel.b1));
  std::array<float, 6> ends = {from, -corner0, -corner1, corner0, corner1, to};
  for (float& end : ends)
    end = std::clamp(end, from, to);
  std::sort(ends.begin(), ends.end());
  double sum = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    if (ends[i] < ends[i + 1])
      sum += rim_strips(map, pixel, ends[i], ends[i + 1]);
  return sum;
}

template <class Map>
double solid_angle(Map map, int x, int y, int width, int height) {
  if constexpr (Map::round) {
    const PixelRectangle pixel(x, y, width, height);
    if (pixel.is_outside())
      return 0;
    if (pixel.crosses_rim())
      return rim_pixel(map, pixel);
  }
  return whole_pixel(map, x, y, width, height);
}

} // namespace

Probe::Probe(const Image& image, Mapping mapping, Lookup lookup, const std::string& path)
    : m_mapping(mapping), m_lookup(lookup), m_width(image.width), m_height(image.height),
      m_path(path) {
  check_shape(image, mapping, path);
  // One float more than the pixels need lets vector loads of a pixel take four.
  m_rgb.resize(3 * static_cast<std::size_t>(m_width + 2) * static_cast<std::size_t>(m_height + 2) +
               1);
  for (int y = 0; y < m_height; ++y)
    std::copy_n(image.rgb.data() + image.offset(0, y), 3 * static_cast<std::size_t>(m_width),
                m_rgb.data() + offset(0, y));
  if (is_round(mapping))
    mask_outside();
  else
    fill_border();
}

void Probe::fill_border() {
  for (int x = 0; x < m_width; ++x) {
    fill_seam(x, -1);
    fill_seam(x, m_height);
  }
  for (int y = -1; y <= m_height; ++y) {
    fill_seam(-1, y);
    fill_seam(m_width, y);
  }
}

/// One border pixel: a copy of the neighbour across the edge of the map.
void Probe::fill_seam(int x, int y) {
  int from_x = std::clamp(x, 0, m_width - 1);
  int from_y = std::clamp(y, 0, m_height - 1);
  const bool over_top = from_y != y;
  const bool over_side = from_x != x;
  if (m_mapping == Mapping::LatLong) {
    const int turned = x + (over_top ? m_width / 2 : 0);
    from_x = (turned % m_width + m_width) % m_width;
  } else { // octahedral: every edge is folded onto itself
    from_x = over_top ? m_width - 1 - from_x : from_x;
    from_y = over_side ? m_height - 1 - from_y : from_y;
  }
  set(x, y, pixel(from_x, from_y));
}

/// Gives pixels just outside the disk the value of the nearest pixel inside, all others black.
void Probe::mask_outside() {
  const float radius = 0.5F * static_cast<float>(m_width);
  for (int y = -1; y <= m_height; ++y) {
    for (int x = -1; x <= m_width; ++x) {
      const Vec2 from_centre(static_cast<float>(x) + 0.5F - radius,
                             static_cast<float>(y) + 0.5F - radius);
      const float distance = from_centre.norm();
      if (distance <= radius)
        continue;
      // A pixel's centre is at most 0.71 pixels from any of its points.
      const Vec2 inside = from_centre * (std::max(0.0F, radius - 0.75F) / distance);
      const bool near = distance < radius + 3.0F;
      const Vec2 place = inside + Vec2(radius, radius);
      set(x, y,
          near ? pixel(static_cast<int>(place.x()), static_cast<int>(place.y())) : Rgb(0, 0, 0));
    }
  }
}

Rgb Probe::radiance(const Vec3& w) const { return looked_up(direction_to_image(m_mapping, w)); }

void Probe::radiance(std::span<const Vec3> directions, std::span<Rgb> out) const {
  constexpr std::size_t batch = 64;
  std::array<Vec2, batch> places;
  for (std::size_t begin = 0; begin < directions.size(); begin += batch) {
    const std::size_t count = std::min(batch, directions.size() - begin);
    with_mapping(m_mapping, [&](auto map) {
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3& w = directions[begin + i];
        map.image(w.x(), w.y(), w.z(), places[i].x(), places[i].y());
      }
    });
    for (std::size_t i = 0; i < count; ++i)
      out[begin + i] = looked_up(places[i]);
  }
}

Rgb Probe::looked_up(const Vec2& uv) const {
  if (m_lookup == Lookup::Bilinear)
    return interpolated(uv);
  const int x = std::min(static_cast<int>(uv.x() * static_cast<float>(m_width)), m_width - 1);
  const int y = std::min(static_cast<int>(uv.y() * static_cast<float>(m_height)), m_height - 1);
  return pixel(x, y);
}

Rgb Probe::interpolated(const Vec2& uv) const {
  // Counted from the centre of the border pixel, so never negative.
  const float fx = uv.x() * static_cast<float>(m_width) + 0.5F;
  const float fy = uv.y() * static_cast<float>(m_height) + 0.5F;
  const int x = std::min(static_cast<int>(fx), m_width);
  const int y = std::min(static_cast<int>(fy), m_height);
  const float s = fx - static_cast<float>(x);
  const float t = fy - static_cast<float>(y);
  return (1 - t) * ((1 - s) * pixel(x - 1, y - 1) + s * pixel(x, y - 1)) +
         t * ((1 - s) * pixel(x - 1, y) + s * pixel(x, y));
}

double Probe::mean_luminance(int x, int y) const {
  if (m_lookup == Lookup::Nearest)
    return luminance(pixel(x, y));
  constexpr double weights[3] = {0.125, 0.75, 0.125};
  double sum = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      sum += weights[i + 1] * weights[j + 1] * luminance(pixel(x + i, y + j));
  return sum;
}

double Probe::pixel_solid_angle(int x, int y) const {
  assert(x >= 0 && x < m_width && y >= 0 && y < m_height);
  if (m_mapping == Mapping::LatLong)
    return latlong_pixel(y, m_width, m_height);
  return with_mapping(m_mapping,
                      [&](auto map) { return solid_angle(map, x, y, m_width, m_height); });
}

Rgb Probe::integral() const {
  std::vector<Eigen::Array3d> rows(static_cast<std::size_t>(m_height), Eigen::Array3d::Zero());
  parallel_for(rows.size(), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < m_width; ++x)
      rows[row] += pixel_solid_angle(x, y) * pixel(x, y).cast<double>();
  });
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const auto& row : rows)
    sum += row;
  return sum.cast<float>();
}

} // namespace haarlight::probe
