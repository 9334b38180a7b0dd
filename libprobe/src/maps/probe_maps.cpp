#include <probe/probe_maps.h>

#include "mapping/point_kernels.h"
#include "maps/area_sum.h"

#include <wavelet/base/error.h>
#include <wavelet/base/lanes.h>
#include <wavelet/base/parallel.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <span>

namespace haarlight::probe {

Frame light_frame(int i, int j, int orientations) {
  const auto cells = static_cast<float>(orientations);
  return frame_about(wavelet::square_to_sphere(
      Vec2((static_cast<float>(i) + 0.5F) / cells, (static_cast<float>(j) + 0.5F) / cells)));
}

Frame carried_frame(const Frame& frame, const Vec3& w) {
  // Rodrigues about n × w; within a cell the two axes are never opposite.
  const Vec3 axis = frame.n.cross(w);
  const float cosine = frame.n.dot(w);
  const float k = 1.0F / std::max(1.0F + cosine, 1e-6F);
  const auto carry = [&](const Vec3& v) -> Vec3 {
    return v * cosine + axis.cross(v) + axis * (axis.dot(v) * k);
  };
  return {carry(frame.t), carry(frame.b), w};
}

int default_map_size(const Probe& probe, int orientations) {
  if (orientations > 1)
    return 128;
  int size = 512;
  while (size < 2048 && size < 3.2 * probe.width())
    size *= 2;
  return size;
}

namespace {

// A world map prepared for rotation.

/// Of peaks: with as few samples as tables have, lights of 3 × 3 pixels need their exact area too
/// (energy of a sun in a map of a 16 × 16 table: off by up to 3 % at 3).
constexpr double table_contrast = 2;

Probe as_probe(const wavelet::Map& map) {
  Image image;
  image.width = map.size;
  image.height = map.size;
  image.rgb = map.rgb;
  return {image, Mapping::Octahedral};
}

/// Offset of a pixel, or of one in the border, one step outside.
std::size_t texel_offset(const RotatableMap& source, int x, int y) {
  return 4 * (static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(source.size + 2) +
              static_cast<std::size_t>(x + 1));
}

/// Every edge is folded onto itself.
void fill_border(RotatableMap& source) {
  const int last = source.size - 1;
  const auto copy = [&](int x, int y) {
    const int inside_x = std::clamp(x, 0, last);
    const int inside_y = std::clamp(y, 0, last);
    const std::size_t from = texel_offset(source, inside_y != y ? last - inside_x : inside_x,
                                          inside_x != x ? last - inside_y : inside_y);
    std::copy_n(source.rgbw.begin() + static_cast<std::ptrdiff_t>(from), 4,
                source.rgbw.begin() + static_cast<std::ptrdiff_t>(texel_offset(source, x, y)));
  };
  for (int i = -1; i <= source.size; ++i) {
    copy(i, -1);
    copy(i, source.size);
    copy(-1, i);
    copy(source.size, i);
  }
}

// Maps in rotated frames.

/// Of the outlines of peaks in one frame, and in those of a table, at least 16 for each map. Maps
/// differ in the fourth digit of the error against nearest look-ups (probes of 8 and 31 pixels, and
/// two captured ones), in a tenth of the time (probes of 8 and 31 pixels, grace).
constexpr Flatness rotation_flatness = {0.02F};
constexpr Flatness table_flatness = {0.15F};

/// Samples of a map in one frame, about 10 ms, where that is between 8² and 32² for each pixel.
constexpr int samples_per_rotation = 1 << 20;

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

/// The same frame throughout, sampled at places in the pixel by the sequence of the plastic number.
std::vector<SampleFrame> frames_of_rotation(const Frame& frame, int count) {
  const auto fraction = [](double x) { return static_cast<float>(x - std::floor(x)); };
  std::vector<SampleFrame> frames;
  frames.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k)
    frames.push_back({frame, Vec2(fraction(0.5 + k * 0.7548776662466927),
                                  fraction(0.5 + k * 0.5698402909980532))});
  return frames;
}

int rotation_samples_along(int size) {
  int along = 8;
  while (along < 32 && 4 * along * along * size * size <= samples_per_rotation)
    along *= 2;
  return along;
}

/// Look-ups in a source, whose border holds the neighbours across the folded edges of the square.
/// Places are counted in pixels from the centre of the border's first.
class SourceLookup {
public:
  explicit SourceLookup(const RotatableMap& source)
      : m_data(source.rgbw.data()), m_row(4 * static_cast<std::size_t>(source.size + 2)) {}

  template <Lookup lookup>
  Float4 at(float column, float row) const {
    if constexpr (lookup == Lookup::Nearest)
      return load_pixel(texel(column + 0.5F, row + 0.5F));
    const float* upper_left = texel(column, row);
    const float s = column - std::floor(column);
    const float t = row - std::floor(row);
    const float* below = upper_left + m_row;
    const Float4 upper =
        load_pixel(upper_left) + (load_pixel(upper_left + 4) - load_pixel(upper_left)) * s;
    const Float4 lower = load_pixel(below) + (load_pixel(below + 4) - load_pixel(below)) * s;
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
  /// @param source, frames must outlive this
  RowSampler(const RotatableMap& source, int size, const std::vector<SampleFrame>& frames)
      : m_size(size), m_source(source), m_look_up(source), m_frames(frames),
        m_points((m_size + point_step - 1) / point_step * point_step),
        m_columns(static_cast<std::size_t>(m_points)), m_rows(m_columns.size()),
        m_sums(m_columns.size()) {}

  void sample(int y) {
    std::fill(m_sums.begin(), m_sums.end(), Sum{});
    for (const SampleFrame& sample : m_frames)
      add(sample, y);
  }

  /// Mean radiance of the pixels not added by area, or nothing if no sample met any.
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
    find_places(sample.frame, m_source.size,
                {sample.in_pixel.x() * step, step,
                 (static_cast<float>(y) + sample.in_pixel.y()) * step, m_points},
                m_columns.data(), m_rows.data());
    for (std::size_t x = 0; x < static_cast<std::size_t>(m_size); ++x)
      m_sums[x].rgbw += m_look_up.template at<lookup>(m_columns[x], m_rows[x]);
  }

  int m_size;
  const RotatableMap& m_source;
  SourceLookup m_look_up;
  const std::vector<SampleFrame>& m_frames;
  int m_points;
  std::vector<float> m_columns;
  std::vector<float> m_rows;
  std::vector<Sum> m_sums;
};

/// Adds the source's peaks as they lie in each frame.
AreaSum peaks_in(const RotatableMap& source, int size, std::span<const SampleFrame> frames,
                 Flatness flatness) {
  AreaSum peaks(size);
  const PictureShape shape = {Mapping::Octahedral, source.size, source.size};
  if (!source.peaks.empty())
    for (const SampleFrame& sample : frames)
      peaks.add(PixelCoverage(shape, size, sample.frame, flatness), source.peaks);
  return peaks;
}

/// One row of a map from its samples and the peaks, which were added in `layers` frames.
template <Lookup lookup>
void make_row(wavelet::Map& map, int y, const RotatableMap& source, RowSampler<lookup>& sampler,
              const AreaSum& peaks, std::size_t layers) {
  sampler.sample(y);
  for (int x = 0; x < map.size; ++x) {
    const std::optional<Rgb> others = sampler.mean(x);
    const Rgb mean =
        peaks.mean(x, y, others ? *others : peaks.covered_mean(x, y), static_cast<float>(layers));
    map.set(x, y, mean * source.unit);
  }
}

/// Side of the world map that a table's maps look up. Each of the frames a cell is averaged over
/// samples the sphere once per map pixel, and the frames lie a √frames-th of the cell apart: pixels
/// of half the larger of the two distances are neither missed nor blurred much more than the cell
/// blurs them (grace at 128², 64 × 64 cells, 16 frames: 8 % of the norm off; 20 % with pixels of
/// the whole distance).
int matching_size(const MapOptions& options, int full_size) {
  const int frames_around = options.orientations * samples_along(options);
  const int wanted = std::min({2 * options.size, 2 * frames_around, full_size});
  int size = 4;
  while (2 * size <= wanted)
    size *= 2;
  return size;
}

/// The map of one cell of ω_r, averaged over the cell.
wavelet::Map cell_average(const RotatableMap& source, const MapOptions& options, int column,
                          int row) {
  wavelet::Map map(options.size);
  const std::vector<SampleFrame> frames = frames_of_cell(options, column, row);
  const AreaSum peaks = peaks_in(source, map.size, frames, table_flatness);
  RowSampler<Lookup::Bilinear> sampler(source, map.size, frames);
  for (int y = 0; y < map.size; ++y)
    make_row(map, y, source, sampler, peaks, frames.size());
  return map;
}

} // namespace

RotatableMap make_rotatable(const wavelet::Map& map, int largest_size) {
  wavelet::Map small = map;
  while (small.size > largest_size)
    small = wavelet::halved(small);
  const Probe probe = as_probe(small);
  RotatableMap source;
  source.size = small.size;
  source.unit = radiance_unit(probe);
  source.rgbw.resize(texel_offset(source, source.size, source.size) + 4);
  for (int y = 0; y < source.size; ++y)
    for (int x = 0; x < source.size; ++x) {
      float* texel = source.rgbw.data() + texel_offset(source, x, y);
      const Rgb radiance = probe.pixel(x, y) / source.unit;
      std::copy_n(radiance.data(), 3, texel);
      texel[3] = 1;
    }
  for (const PixelPlace& place : find_peaks(probe, table_contrast)) {
    source.peaks.push_back({place.x, place.y, probe.pixel(place.x, place.y) / source.unit});
    std::fill_n(source.rgbw.data() + texel_offset(source, place.x, place.y), 4, 0.0F);
  }
  fill_border(source);
  return source;
}

wavelet::Map rotate_map(const RotatableMap& source, const Frame& frame, int size) {
  wavelet::Map map(size);
  const int along = std::max(2 * ((source.size + size - 1) / size), rotation_samples_along(size));
  const std::vector<SampleFrame> frames = frames_of_rotation(frame, along * along);
  const AreaSum peaks = peaks_in(source, size, std::span(frames).first(1), rotation_flatness);
  parallel_ranges(static_cast<std::size_t>(size), 4, [&](std::size_t begin, std::size_t end) {
    RowSampler<Lookup::Nearest> sampler(source, size, frames);
    for (std::size_t y = begin; y < end; ++y)
      make_row(map, static_cast<int>(y), source, sampler, peaks, 1);
  });
  return map;
}

ProbeMaps::ProbeMaps(const Probe& probe, const MapOptions& options, const Provenance& source)
    : m_options(options), m_integral(probe.integral()) {
  if (!m_integral.allFinite())
    throw_input_error(probe.path(), "holds radiances whose integral over the sphere exceeds the "
                                    "largest single-precision number; the picture must be scaled "
                                    "down");
  if (m_options.size == 0)
    m_options.size = default_map_size(probe, m_options.orientations);
  assert(m_options.size >= 4 && m_options.orientations >= 1 && m_options.supersample >= 1);
  describe(source, probe.mapping());
  if (m_options.orientations == 1) {
    m_world = world_map(probe, m_options.size, m_options.supersample);
    return;
  }
  const wavelet::Map full = world_map(probe, default_map_size(probe, 1), m_options.supersample);
  m_source = make_rotatable(full, matching_size(m_options, full.size));
}

void ProbeMaps::describe(const Provenance& source, Mapping mapping) {
  const bool world = m_options.orientations == 1;
  m_info.kind = wavelet::SetKind::Light;
  m_info.size = m_options.size;
  m_info.columns = m_options.orientations;
  m_info.rows = m_options.orientations;
  m_info.world_frame = world;
  m_info.frame = world ? "world: right +x, up +y, forward -z"
                       : "column i, row j of M x M: n = square_to_sphere((i+1/2)/M, (j+1/2)/M) in "
                         "world axes (right +x, up +y, forward -z), t and b of Duff et al. 2017 "
                         "about n; averaged over the cell";
  m_info.units = "radiance of the probe";
  m_info.provenance = source;
  m_info.provenance.set("mapping", mapping_name(mapping));
  m_info.provenance.set("orientations", std::to_string(m_options.orientations));
  m_info.provenance.set("supersample", std::to_string(m_options.supersample));
  m_info.provenance.set("version", version_text());
}

wavelet::Map ProbeMaps::make(int column, int row) const {
  if (m_options.orientations == 1)
    return m_world;
  return cell_average(m_source, m_options, column, row);
}

std::optional<Rgb> ProbeMaps::integral(int /*column*/, int /*row*/) const { return m_integral; }

} // namespace haarlight::probe
