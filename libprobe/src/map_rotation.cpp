#include "map_rotation.h"

#include <wavelet/lanes.h>
#include <wavelet/sphere_map.h>

#include <algorithm>
#include <numeric>

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

/// Frames on a grid over the cell; places in the pixel are the points of the same grid in another
/// order, so that the two are not tied to each other.
std::vector<Look> looks_of_cell(const MapOptions& options, int column, int row) {
  const Frame centre = light_frame(column, row, options.orientations);
  const int along = samples_along(options);
  const int count = along * along;
  int stride = std::max(1, count * 5 / 8); // about the golden section
  while (std::gcd(stride, count) != 1)
    ++stride;
  std::vector<Look> looks;
  const auto on_grid = [&](int k) -> Vec2 {
    return Vec2((static_cast<float>(k % along) + 0.5F), (static_cast<float>(k / along) + 0.5F)) /
           static_cast<float>(along);
  };
  for (int k = 0; k < count; ++k) {
    const Vec2 cell(static_cast<float>(column), static_cast<float>(row));
    const Vec2 square = (cell + on_grid(k)) / static_cast<float>(options.orientations);
    looks.push_back(
        {carried_frame(centre, wavelet::square_to_sphere(square)), on_grid(k * stride % count)});
  }
  return looks;
}

Float4 load(const float* values) {
  Float4 result;
  __builtin_memcpy(&result, values, sizeof result);
  return result;
}

/// Bilinear look-ups in a level, across the folded edges of the square.
class Sampler {
public:
  explicit Sampler(const WorldLevel& level)
      : m_data(level.rgbx.data()), m_row(4 * static_cast<std::size_t>(level.size + 2)),
        m_size(static_cast<float>(level.size)) {}

  /// Adds four neighbouring pixels' samples to four sums.
  void add(const Look& look, Float4 square_u, Float4 square_v, Float4* sums) const {
    Float4 lx;
    Float4 ly;
    Float4 lz;
    wavelet::square_to_sphere(square_u, square_v, lx, ly, lz);
    const Frame& f = look.frame;
    const Float4 x = lx * f.t.x() + ly * f.b.x() + lz * f.n.x();
    const Float4 y = lx * f.t.y() + ly * f.b.y() + lz * f.n.y();
    const Float4 z = lx * f.t.z() + ly * f.b.z() + lz * f.n.z();
    Float4 u;
    Float4 v;
    wavelet::sphere_to_square(x, y, z, u, v);
    // Counted from the centre of the border pixel, so never negative.
    const Float4 column = smaller(u, broadcast<Float4>(1)) * m_size + 0.5F;
    const Float4 row = smaller(v, broadcast<Float4>(1)) * m_size + 0.5F;
    const Int4 ix = __builtin_convertvector(column, Int4);
    const Int4 iy = __builtin_convertvector(row, Int4);
    const Float4 s = column - __builtin_convertvector(ix, Float4);
    const Float4 t = row - __builtin_convertvector(iy, Float4);
    for (int i = 0; i < 4; ++i)
      sums[i] += interpolated(ix[i], iy[i], s[i], t[i]);
  }

private:
  Float4 interpolated(int x, int y, float s, float t) const {
    const float* texel =
        m_data + static_cast<std::size_t>(y) * m_row + 4 * static_cast<std::size_t>(x);
    const Float4 upper = load(texel) + (load(texel + 4) - load(texel)) * s;
    const float* below = texel + m_row;
    const Float4 lower = load(below) + (load(below + 4) - load(below)) * s;
    return upper + (lower - upper) * t;
  }

  const float* m_data;
  std::size_t m_row;
  float m_size;
};

void make_row(const Sampler& sampler, const std::vector<Look>& looks, wavelet::Map& map, int y,
              std::vector<Float4>& sums) {
  const auto size = static_cast<float>(map.size);
  std::fill(sums.begin(), sums.end(), Float4{});
  for (const Look& look : looks) {
    const Float4 v = broadcast<Float4>((static_cast<float>(y) + look.in_pixel.y()) / size);
    for (int x = 0; x < map.size; x += 4) {
      const Float4 u = (static_cast<float>(x) + look.in_pixel.x() + Float4{0, 1, 2, 3}) / size;
      sampler.add(look, u, v, sums.data() + x);
    }
  }
  const float share = 1.0F / static_cast<float>(looks.size());
  for (int x = 0; x < map.size; ++x) {
    const Float4 mean = sums[static_cast<std::size_t>(x)] * share;
    map.set(x, y, Rgb(mean[0], mean[1], mean[2]));
  }
}

/// Averages squares of two by two pixels.
wavelet::Map halved(const wavelet::Map& map) {
  wavelet::Map half(map.size / 2);
  for (int y = 0; y < half.size; ++y)
    for (int x = 0; x < half.size; ++x)
      half.set(x, y,
               0.25F * ((map.at(2 * x, 2 * y) + map.at(2 * x + 1, 2 * y)) +
                        (map.at(2 * x, 2 * y + 1) + map.at(2 * x + 1, 2 * y + 1))));
  return half;
}

/// The pixel that stands at (x, y), up to one step over an edge: edges are folded onto themselves.
Rgb folded_pixel(const wavelet::Map& map, int x, int y) {
  const int last = map.size - 1;
  const bool over_side = x < 0 || x > last;
  const bool over_top = y < 0 || y > last;
  const int from_x = std::clamp(x, 0, last);
  const int from_y = std::clamp(y, 0, last);
  return map.at(over_top ? last - from_x : from_x, over_side ? last - from_y : from_y);
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

WorldLevel make_level(const wavelet::Map& map, int size) {
  wavelet::Map small = map;
  while (small.size > size)
    small = halved(small);
  WorldLevel level;
  level.size = small.size;
  const int side = small.size + 2;
  level.rgbx.resize(4 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto index = static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                         static_cast<std::size_t>(x);
      Eigen::Map<Rgb>(level.rgbx.data() + 4 * index) = folded_pixel(small, x - 1, y - 1);
    }
  return level;
}

wavelet::Map rotated_map(const WorldLevel& level, const MapOptions& options, int column, int row) {
  const std::vector<Look> looks = looks_of_cell(options, column, row);
  const Sampler sampler(level);
  wavelet::Map map(options.size);
  std::vector<Float4> sums(static_cast<std::size_t>(map.size));
  for (int y = 0; y < map.size; ++y)
    make_row(sampler, looks, map, y, sums);
  return map;
}

} // namespace haarlight::probe
