#include <probe/probe.h>

#include "mapping/mapping_lanes.h"
#include "maps/pixel_shape.h"

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
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

/// Four-point Gauss quadrature of the density over a pixel that lies wholly in the map.
template <class Map>
double whole_pixel(Map map, int x, int y, int width, int height) {
  constexpr float g = 0.28867513F;
  const Float4 u =
      (static_cast<float>(x) + 0.5F + Float4{-g, g, -g, g}) / static_cast<float>(width);
  const Float4 v =
      (static_cast<float>(y) + 0.5F + Float4{-g, -g, g, g}) / static_cast<float>(height);
  const Float4 d = map.density(u, v);
  return 0.25 * (static_cast<double>(d[0]) + d[1] + d[2] + d[3]) / width / height;
}

/// A pixel the rim runs through: strips across it, each of the length that lies inside.
template <class Map>
double rim_pixel(Map map, const PixelRectangle& pixel) {
  constexpr int strips = 16;
  float a_from = 0;
  float a_to = 0;
  pixel.columns(a_from, a_to);
  double sum = 0;
  for (int i = 0; i < strips; ++i) {
    const float a = a_from + (a_to - a_from) * (static_cast<float>(i) + 0.5F) / strips;
    float b_from = 0;
    float b_to = 0;
    pixel.rows(a, b_from, b_to);
    for (int j = 0; j < strips; ++j) {
      const float b = b_from + (b_to - b_from) * (static_cast<float>(j) + 0.5F) / strips;
      sum += static_cast<double>(map.density(0.5F + 0.5F * a, 0.5F + 0.5F * b)) * (b_to - b_from);
    }
  }
  return 0.25 * sum * (a_to - a_from) / (strips * strips);
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

/// One border pixel: what lies beyond the edge of the map there.
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
