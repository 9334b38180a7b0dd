#include <probe/probe_maps.h>

#include "mapping/mapping_lanes.h"
#include "mapping/point_kernels.h"
#include "maps/area_sum.h"

#include <wavelet/base/parallel.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace haarlight::probe {
namespace {

/// Samples that a probe pixel gets at least, where the sampling of map pixels can be chosen so.
constexpr float samples_per_texel = 64;
constexpr int most_samples_along = 64;

/// Probes are added by area altogether, without sampling, if a pixel covers this many map pixels on
/// average: then that is as fast (measured with 512 × 256 pixels at 2048²; at 8 it takes a sixth
/// longer). Small probes are in any case, for which it takes less than 0.1 s.
constexpr double coarse_pixel = 16;
constexpr double small_probe = 65536;

Vec3 pixel_centre(int x, int y, int size) {
  return wavelet::square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                                        (static_cast<float>(y) + 0.5F) / static_cast<float>(size)));
}

/// The probe as four floats for each pixel, row by row: radiance in units of `unit`, and 1; all 0
/// for pixels that are not left to sampling.
std::vector<float> sampled_pixels(const Probe& probe, const std::vector<SourcePixel>& exact,
                                  float unit) {
  const auto width = static_cast<std::size_t>(probe.width());
  std::vector<float> pixels(4 * width * static_cast<std::size_t>(probe.height()));
  parallel_for(static_cast<std::size_t>(probe.height()), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      float* pixel = pixels.data() + 4 * (y * width + x);
      const Rgb radiance = probe.pixel(static_cast<int>(x), static_cast<int>(y)) / unit;
      std::copy_n(radiance.data(), 3, pixel);
      pixel[3] = 1;
    }
  });
  for (const SourcePixel& pixel : exact)
    std::fill_n(pixels.data() + 4 * (static_cast<std::size_t>(pixel.y) * width +
                                     static_cast<std::size_t>(pixel.x)),
                4, 0.0F);
  return pixels;
}

/// Averages the sampled pixels over the squares of a map.
template <class Map>
class Gatherer {
public:
  /// @param pixels as sampled_pixels() returns; must outlive this
  Gatherer(const Probe& probe, const std::vector<float>& pixels, int size, int supersample)
      : m_pixels(pixels), m_shape{probe.mapping(), probe.width(), probe.height()},
        m_size(static_cast<float>(size)), m_supersample(supersample) {}

  /// The mean, or nothing if no sample meets a pixel that is left to sampling.
  std::optional<Rgb> average(int x, int y) const {
    std::array<std::int32_t, most_samples_along * most_samples_along> texels;
    const PointGrid points = grid_in(x, y);
    find_texels(m_shape, points, texels.data());
    const int count = points.columns * points.rows;
    const Float4 sum = sum_of(std::span(texels).first(static_cast<std::size_t>(count)));
    if (sum[3] == 0)
      return std::nullopt;
    return Rgb(sum[0], sum[1], sum[2]) / sum[3];
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
    const Vec3 w = pixel_centre(x, y, static_cast<int>(m_size));
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
        even += load_pixel(m_pixels.data() + 4 * static_cast<std::size_t>(texels[k]));
        odd += load_pixel(m_pixels.data() + 4 * static_cast<std::size_t>(texels[k + 1]));
      }
      sum += even + odd;
    }
    return sum;
  }

  const std::vector<float>& m_pixels;
  PictureShape m_shape;
  float m_size;
  int m_supersample;
};

/// The pixels that are added by area, in units of `unit`.
std::vector<SourcePixel> exact_pixels(const Probe& probe, bool all, float unit) {
  std::vector<SourcePixel> pixels;
  if (all) {
    for (int y = 0; y < probe.height(); ++y)
      for (int x = 0; x < probe.width(); ++x)
        pixels.push_back({x, y, probe.pixel(x, y) / unit});
    return pixels;
  }
  for (const PixelPlace& place : find_peaks(probe))
    pixels.push_back({place.x, place.y, probe.pixel(place.x, place.y) / unit});
  return pixels;
}

} // namespace

wavelet::Map world_map(const Probe& probe, int size, int supersample) {
  assert(size >= 4 && supersample >= 1 && supersample <= most_samples_along);
  const auto map_pixels = static_cast<double>(size) * size;
  const double probe_pixels = static_cast<double>(probe.width()) * probe.height();
  const bool coarse = probe_pixels <= std::max(small_probe, map_pixels / coarse_pixel);
  const float unit = radiance_unit(probe);
  const std::vector<SourcePixel> exact_part = exact_pixels(probe, coarse, unit);
  AreaSum exact(size);
  exact.add(PixelCoverage({probe.mapping(), probe.width(), probe.height()}, size), exact_part);
  const std::vector<float> pixels =
      coarse ? std::vector<float>() : sampled_pixels(probe, exact_part, unit);
  wavelet::Map map(size);
  with_mapping(probe.mapping(), [&](auto mapping) {
    const Gatherer<decltype(mapping)> gatherer(probe, pixels, size, supersample);
    parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < size; ++x) {
        std::optional<Rgb> others;
        if (!coarse)
          others = gatherer.average(x, y);
        if (!others) // a few thousandths of the pixel at most
          others = probe.radiance(pixel_centre(x, y, size)) / unit;
        const Rgb mean = exact.mean(x, y, *others);
        map.set(x, y, (mean * unit).min(std::numeric_limits<float>::max()));
      }
    });
  });
  return map;
}

} // namespace haarlight::probe
