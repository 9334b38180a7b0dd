#include "maps/map_rotation.h"

#include "mapping/point_kernels.h"
#include "maps/area_sum.h"

#include <wavelet/base/lanes.h>
#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace haarlight::probe {
namespace {

/// Of the outlines of peaks in one frame, and in those of a table, at least 16 for each map. Maps
/// differ from those of the default flatness by less than 0.0002 of their norm, in a tenth of the
/// time (probes of 8 and 31 pixels, grace).
constexpr Flatness flatness_of_turns = {0.02F};
constexpr Flatness flatness_of_tables = {0.15F};

/// Samples of a map in one frame, about 3 ms, where that is between 8² and 32² for each pixel.
constexpr int samples_of_turn = 1 << 20;

/// Square root of the number of samples of a pixel, each in a frame of its own: about a map pixel
/// apart where cells are large.
int samples_along(const MapOptions& options) {
  return std::max(options.supersample, std::min(options.size / options.orientations, 16));
}

/// A frame of the cell, and the place in every pixel where its sample is taken.
struct SampleFrame {
  Frame frame;
  Vec2 in_pixel;
};

/// Coordinate 0 to 3 of point k of the additive lattice of the generalised golden ratio of four
/// dimensions (the root of x⁵ = x + 1; Roberts 2018).
float lattice(int k, int coordinate) {
  constexpr double steps[4] = {0.8566748838545029, 0.7338918566271260, 0.6287067210378087,
                               0.5385972572236101};
  const double x = 0.5 + k * steps[coordinate];
  return static_cast<float>(x - std::floor(x));
}

/// Points of a lattice over cell and pixel, so that edges at any angle are met at as many places as
/// there are samples: 16 of them err as little as a grid of 64 frames (grace at 128², 64 × 64
/// cells).
std::vector<SampleFrame> frames_of_cell(const MapOptions& options, int column, int row) {
  const Frame centre = light_frame(column, row, options.orientations);
  const int along = samples_along(options);
  const auto cells = static_cast<float>(options.orientations);
  std::vector<SampleFrame> frames;
  for (int k = 0; k < along * along; ++k) {
    const Vec2 in_cell(lattice(k, 1), lattice(k, 2));
    const Vec2 cell(static_cast<float>(column), static_cast<float>(row));
    frames.push_back({carried_frame(centre, wavelet::square_to_sphere((cell + in_cell) / cells)),
                      Vec2(lattice(k, 0), lattice(k, 3))});
  }
  return frames;
}

Float4 load(const float* values) {
  Float4 result;
  __builtin_memcpy(&result, values, sizeof result);
  return result;
}

/// The same frame throughout, sampled at places in the pixel by the sequence of the plastic number.
std::vector<SampleFrame> frames_of_turn(const Frame& frame, int count) {
  const auto fraction = [](double x) { return static_cast<float>(x - std::floor(x)); };
  std::vector<SampleFrame> frames;
  frames.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    frames.push_back({frame, Vec2(fraction(0.5 + k * 0.7548776662466927),
                                  fraction(0.5 + k * 0.5698402909980532))});
  return frames;
}

int turn_samples_along(int size) {
  int along = 8;
  while (along < 32 && 4 * along * along * size * size <= samples_of_turn)
    along *= 2;
  return along;
}

/// Look-ups in a level, whose border holds what lies beyond the folded edges of the square. Places
/// are counted in pixels from the centre of the border's first.
class LevelLookup {
public:
  explicit LevelLookup(const WorldLevel& level)
      : m_data(level.rgbw.data()), m_row(4 * static_cast<std::size_t>(level.size + 2)) {}

  template <Lookup lookup>
  Float4 at(float column, float row) const {
    if constexpr (lookup == Lookup::Nearest)
      return load(texel(column + 0.5F, row + 0.5F));
    const float* upper_left = texel(column, row);
    const float s = column - std::floor(column);
    const float t = row - std::floor(row);
    const float* below = upper_left + m_row;
    const Float4 upper = load(upper_left) + (load(upper_left + 4) - load(upper_left)) * s;
    const Float4 lower = load(below) + (load(below + 4) - load(below)) * s;
    return upper + (lower - upper) * t;
  }

private:
  const float* texel(float column, float row) const {
    return m_data + static_cast<std::size_t>(row) * m_row + 4 * static_cast<std::size_t>(column);
  }

  const float* m_data;
  std::size_t m_row;
};

/// Sums the samples of one row of a map after another.
template <Lookup lookup>
class RowSampler {
public:
  /// @param level, frames must outlive this
  RowSampler(const WorldLevel& level, int size, const std::vector<SampleFrame>& frames)
      : m_size(size), m_level(level), m_look_up(level), m_frames(frames),
        m_points((m_size + point_step - 1) / point_step * point_step),
        m_columns(static_cast<std::size_t>(m_points)), m_rows(m_columns.size()),
        m_sums(m_columns.size()) {}

  void sample(int y) {
    std::fill(m_sums.begin(), m_sums.end(), Sum{});
    for (const SampleFrame& sample : m_frames)
      add(sample, y);
  }

  /// Radiance of what is not added by area, or nothing if no sample met any of it.
  std::optional<Rgb> mean(int x) const {
    const Float4& sum = m_sums[static_cast<std::size_t>(x)].rgbw;
    if (sum[3] <= 0)
      return std::nullopt;
    return Rgb(sum[0], sum[1], sum[2]) / sum[3];
  }

private:
  struct Sum {
    Float4 rgbw = {};
  };

  void add(const SampleFrame& sample, int y) {
    const float step = 1.0F / static_cast<float>(m_size);
    find_places(sample.frame, m_level.size,
                {sample.in_pixel.x() * step, step,
                 (static_cast<float>(y) + sample.in_pixel.y()) * step, m_points},
                m_columns.data(), m_rows.data());
    for (std::size_t x = 0; x < static_cast<std::size_t>(m_size); ++x)
      m_sums[x].rgbw += m_look_up.template at<lookup>(m_columns[x], m_rows[x]);
  }

  int m_size;
  const WorldLevel& m_level;
  LevelLookup m_look_up;
  const std::vector<SampleFrame>& m_frames;
  int m_points;
  std::vector<float> m_columns;
  std::vector<float> m_rows;
  std::vector<Sum> m_sums;
};

/// Adds the level's peaks as they lie in each frame.
AreaSum peaks_in(const WorldLevel& level, int size, std::span<const SampleFrame> frames,
                 Flatness flatness) {
  AreaSum peaks(size);
  const PictureShape shape = {Mapping::Octahedral, level.size, level.size};
  if (!level.peaks.empty())
    for (const SampleFrame& sample : frames)
      peaks.add(PixelCoverage(shape, size, sample.frame, flatness), level.peaks);
  return peaks;
}

/// One row of a map from its samples and the peaks, which were added in `layers` frames.
template <Lookup lookup>
void make_row(wavelet::Map& map, int y, const WorldLevel& level, RowSampler<lookup>& sampler,
              const AreaSum& peaks, std::size_t layers) {
  sampler.sample(y);
  for (int x = 0; x < map.size; ++x) {
    const std::optional<Rgb> others = sampler.mean(x);
    const Rgb mean =
        peaks.mean(x, y, others ? *others : peaks.covered_mean(x, y), static_cast<float>(layers));
    map.set(x, y, mean * level.unit);
  }
}

} // namespace

int matching_level_size(const MapOptions& options, int full_size) {
  const int frames_around = options.orientations * samples_along(options);
  const int wanted = std::min({2 * options.size, 2 * frames_around, full_size});
  int size = 4;
  while (2 * size <= wanted)
    size *= 2;
  return size;
}

wavelet::Map rotated_map(const WorldLevel& level, const MapOptions& options, int column, int row) {
  wavelet::Map map(options.size);
  const std::vector<SampleFrame> frames = frames_of_cell(options, column, row);
  const AreaSum peaks = peaks_in(level, map.size, frames, flatness_of_tables);
  RowSampler<Lookup::Bilinear> sampler(level, map.size, frames);
  for (int y = 0; y < map.size; ++y)
    make_row(map, y, level, sampler, peaks, frames.size());
  return map;
}

WorldLevel turning_level(const wavelet::Map& world) { return make_level(world, world.size); }

wavelet::Map turned_map(const WorldLevel& level, const Frame& frame, int size) {
  wavelet::Map map(size);
  const int along = std::max(2 * ((level.size + size - 1) / size), turn_samples_along(size));
  const std::vector<SampleFrame> frames = frames_of_turn(frame, along * along);
  const AreaSum peaks = peaks_in(level, size, std::span(frames).first(1), flatness_of_turns);
  parallel_ranges(static_cast<std::size_t>(size), 4, [&](std::size_t begin, std::size_t end) {
    RowSampler<Lookup::Nearest> sampler(level, size, frames);
    for (std::size_t y = begin; y < end; ++y)
      make_row(map, static_cast<int>(y), level, sampler, peaks, 1);
  });
  return map;
}

} // namespace haarlight::probe
