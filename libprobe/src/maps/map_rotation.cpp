#include "maps/map_rotation.h"

#include "mapping/point_kernels.h"

#include <wavelet/base/lanes.h>
#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>

namespace haarlight::probe {
namespace {

/// Samples along each side of a pixel, and frames along each side of a cell: more where few cells
/// are large.
int samples_along(const MapOptions& options) {
  const int cell = options.size / (2 * options.orientations); // in pairs of map pixels
  return std::max(options.supersample, std::min(cell, 16));
}

/// One look at the sphere: a frame in the cell, and the place in every pixel where it is taken.
struct Look {
  Frame frame;
  Vec2 in_pixel;
};

/// Frames on a grid over the cell; places in the pixel by the sequence of the plastic number, so
/// that together they fall everywhere between the pixels of the world.
std::vector<Look> looks_of_cell(const MapOptions& options, int column, int row) {
  const Frame centre = light_frame(column, row, options.orientations);
  const int along = samples_along(options);
  const auto fraction = [](double x) { return static_cast<float>(x - std::floor(x)); };
  std::vector<Look> looks;
  for (int k = 0; k < along * along; ++k) {
    const int down = k / along;
    const Vec2 cell(static_cast<float>(column), static_cast<float>(row));
    const Vec2 in_cell(static_cast<float>(k % along) + 0.5F, static_cast<float>(down) + 0.5F);
    const Vec2 square =
        (cell + in_cell / static_cast<float>(along)) / static_cast<float>(options.orientations);
    const Vec2 in_pixel(fraction(0.5 + k * 0.7548776662466927),
                        fraction(0.5 + k * 0.5698402909980532));
    looks.push_back({carried_frame(centre, wavelet::square_to_sphere(square)), in_pixel});
  }
  return looks;
}

Float4 load(const float* values) {
  Float4 result;
  __builtin_memcpy(&result, values, sizeof result);
  return result;
}

/// The same frame all over, at places in the pixel as above.
std::vector<Look> looks_of_frame(const Frame& frame, int count) {
  const auto fraction = [](double x) { return static_cast<float>(x - std::floor(x)); };
  std::vector<Look> looks;
  looks.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    looks.push_back({frame, Vec2(fraction(0.5 + k * 0.7548776662466927),
                                 fraction(0.5 + k * 0.5698402909980532))});
  return looks;
}

/// Bilinear look-ups in a level, whose border holds what lies beyond the folded edges of the
/// square.
class Sampler {
public:
  explicit Sampler(const WorldLevel& level)
      : m_data(level.rgbx.data()), m_row(4 * static_cast<std::size_t>(level.size + 2)) {}

  Float4 at(float column, float row) const {
    const int x = static_cast<int>(column);
    const int y = static_cast<int>(row);
    const float s = column - static_cast<float>(x);
    const float t = row - static_cast<float>(y);
    const float* texel =
        m_data + static_cast<std::size_t>(y) * m_row + 4 * static_cast<std::size_t>(x);
    const Float4 upper = load(texel) + (load(texel + 4) - load(texel)) * s;
    const float* below = texel + m_row;
    const Float4 lower = load(below) + (load(below + 4) - load(below)) * s;
    return upper + (lower - upper) * t;
  }

private:
  const float* m_data;
  std::size_t m_row;
};

/// Makes the rows of one map; what it needs for a row is allocated once.
class RowMaker {
public:
  /// @param looks must outlive this
  RowMaker(const WorldLevel& level, int size, const std::vector<Look>& looks)
      : m_size(size), m_level_size(level.size), m_sampler(level), m_looks(looks),
        m_points((m_size + point_step - 1) / point_step * point_step),
        m_columns(static_cast<std::size_t>(m_points)), m_rows(m_columns.size()),
        m_sums(m_columns.size()) {}

  void make(wavelet::Map& map, int y) {
    std::fill(m_sums.begin(), m_sums.end(), Sum{});
    for (const Look& look : m_looks)
      add(look, y);
    const float share = 1.0F / static_cast<float>(m_looks.size());
    for (int x = 0; x < m_size; ++x) {
      const Float4 mean = m_sums[static_cast<std::size_t>(x)].rgbx * share;
      map.set(x, y, Rgb(mean[0], mean[1], mean[2]));
    }
  }

private:
  struct Sum {
    Float4 rgbx = {};
  };

  void add(const Look& look, int y) {
    const float step = 1.0F / static_cast<float>(m_size);
    find_places(look.frame, m_level_size,
                {look.in_pixel.x() * step, step, (static_cast<float>(y) + look.in_pixel.y()) * step,
                 m_points},
                m_columns.data(), m_rows.data());
    for (std::size_t x = 0; x < static_cast<std::size_t>(m_size); ++x)
      m_sums[x].rgbx += m_sampler.at(m_columns[x], m_rows[x]);
  }

  int m_size;
  int m_level_size;
  Sampler m_sampler;
  const std::vector<Look>& m_looks;
  int m_points;
  std::vector<float> m_columns;
  std::vector<float> m_rows;
  std::vector<Sum> m_sums;
};

/// Adds to a pixel, up to one step over an edge: edges are folded onto themselves.
void add_folded(wavelet::Map& map, int x, int y, const Rgb& value) {
  const int last = map.size - 1;
  const int to_x = std::clamp(x, 0, last);
  const int to_y = std::clamp(y, 0, last);
  const std::size_t offset =
      map.offset(to_y != y ? last - to_x : to_x, to_x != x ? last - to_y : to_y);
  Eigen::Map<Rgb>(map.rgb.data() + offset) += value;
}

/// Shares a light among the four pixels whose centres are nearest, as the look-ups do.
void add_light(wavelet::Map& map, const Vec3& local, const Rgb& radiance) {
  const Vec2 place = wavelet::sphere_to_square(local) * static_cast<float>(map.size);
  const float column = std::floor(place.x() - 0.5F);
  const float row = std::floor(place.y() - 0.5F);
  const float s = place.x() - 0.5F - column;
  const float t = place.y() - 0.5F - row;
  const int x = static_cast<int>(column);
  const int y = static_cast<int>(row);
  add_folded(map, x, y, (1 - s) * (1 - t) * radiance);
  add_folded(map, x + 1, y, s * (1 - t) * radiance);
  add_folded(map, x, y + 1, (1 - s) * t * radiance);
  add_folded(map, x + 1, y + 1, s * t * radiance);
}

void add_lights(wavelet::Map& map, const WorldLevel& level, const std::vector<Look>& looks) {
  const float pixel = wavelet::sphere_area / static_cast<float>(map.size * map.size);
  const float share = 1.0F / (pixel * static_cast<float>(looks.size()));
  for (const Look& look : looks)
    for (const WorldLevel::Light& light : level.lights)
      add_light(map, look.frame.to_local(light.direction), light.power * share);
}

} // namespace

int matching_level_size(const MapOptions& options, int full_size) {
  const int wanted =
      std::min({options.size, options.orientations * samples_along(options), full_size});
  int size = 4;
  while (2 * size <= wanted)
    size *= 2;
  return size;
}

wavelet::Map rotated_map(const WorldLevel& level, const MapOptions& options, int column, int row) {
  wavelet::Map map(options.size);
  const std::vector<Look> looks = looks_of_cell(options, column, row);
  RowMaker maker(level, options.size, looks);
  for (int y = 0; y < map.size; ++y)
    maker.make(map, y);
  add_lights(map, level, looks);
  return map;
}

WorldLevel turning_level(const wavelet::Map& world) {
  return make_level(world, world.size, world.size);
}

wavelet::Map turned_map(const WorldLevel& level, const Frame& frame, int size) {
  wavelet::Map map(size);
  const int along = 2 * std::max(1, (level.size + size - 1) / size);
  const std::vector<Look> looks = looks_of_frame(frame, along * along);
  parallel_ranges(static_cast<std::size_t>(size), 4, [&](std::size_t begin, std::size_t end) {
    RowMaker maker(level, size, looks);
    for (std::size_t y = begin; y < end; ++y)
      maker.make(map, static_cast<int>(y));
  });
  add_lights(map, level, {looks.front()});
  return map;
}

} // namespace haarlight::probe
