#include <probe/probe_maps.h>

#include "mapping/mapping_lanes.h"
#include "mapping/point_kernels.h"
#include "maps/peaks.h"
#include "maps/pixel_coverage.h"

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

Float4 load(const float* values) {
  Float4 result;
  __builtin_memcpy(&result, values, sizeof result);
  return result;
}

Vec3 pixel_centre(int x, int y, int size) {
  return wavelet::square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                                        (static_cast<float>(y) + 0.5F) / static_cast<float>(size)));
}

/// The probe as four floats for each pixel, row by row: radiance in units of `unit`, and 1; all 0
/// for pixels that are not left to sampling.
std::vector<float> sampled_pixels(const Probe& probe, const std::vector<PixelPlace>& exact,
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
  for (const PixelPlace& place : exact)
    std::fill_n(pixels.data() + 4 * (static_cast<std::size_t>(place.y) * width +
                                     static_cast<std::size_t>(place.x)),
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
        even += load(m_pixels.data() + 4 * static_cast<std::size_t>(texels[k]));
        odd += load(m_pixels.data() + 4 * static_cast<std::size_t>(texels[k + 1]));
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

/// Adds the probe pixels that are not left to sampling, by the area that each covers.
class ExactPart {
public:
  ExactPart(const Probe& probe, float unit, wavelet::Map& map)
      : m_probe(probe), m_unit(unit), m_map(map),
        m_covered(static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size)) {}

  /// Pixels are clipped side by side but added in their order, a batch at a time.
  void add(const std::vector<PixelPlace>& places) {
    constexpr std::size_t batch = 4096;
    constexpr std::size_t group = 64;
    std::vector<Group> groups(batch / group);
    for (std::size_t begin = 0; begin < places.size(); begin += batch) {
      const auto part = std::span(places).subspan(begin, std::min(batch, places.size() - begin));
      parallel_for((part.size() + group - 1) / group, [&](std::size_t g) {
        const std::size_t from = g * group;
        clip(part.subspan(from, std::min(group, part.size() - from)), groups[g]);
      });
      for (std::size_t i = 0; i < part.size(); ++i)
        add_pixel(part[i], groups[i / group], i % group);
    }
  }

  /// Fraction of a map pixel that the pixels added cover.
  float covered(int x, int y) const { return m_covered[m_map.offset(x, y) / 3]; }

private:
  struct Group {
    std::vector<CoveredPixel> covered;
    std::vector<std::size_t> ends; ///< in covered, of each probe pixel
  };

  void clip(std::span<const PixelPlace> places, Group& group) const {
    group.covered.clear();
    group.ends.clear();
    PixelCoverage coverage(m_probe, m_map.size);
    for (const PixelPlace& place : places) {
      coverage.append(place.x, place.y, group.covered);
      group.ends.push_back(group.covered.size());
    }
  }

  void add_pixel(const PixelPlace& place, const Group& group, std::size_t i) {
    const Rgb radiance = m_probe.pixel(place.x, place.y) / m_unit;
    for (std::size_t k = i == 0 ? 0 : group.ends[i - 1]; k < group.ends[i]; ++k) {
      const CoveredPixel& pixel = group.covered[k];
      Eigen::Map<Rgb>(m_map.rgb.data() + 3 * std::size_t{pixel.index}) += pixel.fraction * radiance;
      m_covered[pixel.index] += pixel.fraction;
    }
  }

  const Probe& m_probe;
  float m_unit;
  wavelet::Map& m_map;
  std::vector<float> m_covered;
};

std::vector<PixelPlace> all_places(const Probe& probe) {
  std::vector<PixelPlace> places;
  for (int y = 0; y < probe.height(); ++y)
    for (int x = 0; x < probe.width(); ++x)
      places.push_back({x, y});
  return places;
}

/// A power of two by which the probe's radiances are divided so that sums of samples stay finite; 1
/// for all but extreme ones.
float radiance_unit(const Probe& probe) {
  float largest = 0;
  for (int y = 0; y < probe.height(); ++y)
    for (int x = 0; x < probe.width(); ++x)
      largest = std::max(largest, probe.pixel(x, y).maxCoeff());
  return largest > 0x1p96F ? 0x1p32F : 1.0F;
}

/// The mean of a map pixel, convex in the radiances of the probe's pixels.
Rgb combined(const Rgb& exact_sum, float covered, const Rgb& others) {
  const float rest = std::max(0.0F, 1 - covered);
  return (exact_sum + rest * others) / (covered + rest);
}

} // namespace

wavelet::Map world_map(const Probe& probe, int size, int supersample) {
  assert(size >= 4 && supersample >= 1 && supersample <= most_samples_along);
  const auto map_pixels = static_cast<double>(size) * size;
  const double probe_pixels = static_cast<double>(probe.width()) * probe.height();
  const bool coarse = probe_pixels <= std::max(small_probe, map_pixels / coarse_pixel);
  const float unit = radiance_unit(probe);
  const std::vector<PixelPlace> places = coarse ? all_places(probe) : find_peaks(probe);
  wavelet::Map map(size);
  ExactPart exact(probe, unit, map);
  exact.add(places);
  const std::vector<float> pixels =
      coarse ? std::vector<float>() : sampled_pixels(probe, places, unit);
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
        const Rgb mean = combined(map.at(x, y), exact.covered(x, y), *others);
        map.set(x, y, (mean * unit).min(std::numeric_limits<float>::max()));
      }
    });
  });
  return map;
}

} // namespace haarlight::probe
