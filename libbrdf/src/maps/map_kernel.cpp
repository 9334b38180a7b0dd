#include "maps/map_kernel.h"

#include <wavelet/base/elementary.h>
#include <wavelet/base/hash.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::brdf {
namespace {

constexpr int tile_size = 8; // pixels
constexpr int squares_per_batch = batch_capacity / 4;
constexpr float smallest_side = 1.0F / (1 << 18);
/// Width of a square of the domain, radians, over its side: the root of 4π.
constexpr float width_per_side = 3.5449077F;
/// Bound of the angle between the middle of a square and its farthest corner, over its width.
constexpr float radius_per_width = 1.21F;

/// The bits of i < 256 in reverse order, over 256.
double radical_inverse(int i) {
  int reversed = 0;
  for (int bit = 0; bit < 8; ++bit)
    reversed |= ((i >> bit) & 1) << (7 - bit);
  return reversed / 256.0;
}

constexpr float orders[4][4] = {{0, 2, 3, 1}, {2, 0, 1, 3}, {3, 1, 0, 2}, {1, 3, 2, 0}};

Eigen::Vector3d normal_at(double theta_r, double phi) {
  const SineCosine t = sine_cosine(theta_r);
  const SineCosine p = sine_cosine(phi);
  return {t.sine * p.cosine, t.sine * p.sine, t.cosine};
}

} // namespace

/// One map in the making.
struct MapKernel::Job {
  wavelet::Map map;
  std::vector<Float4> sums; ///< by pixel
  std::vector<Square> waiting;
  SampleBatch batch;
  Square taken[squares_per_batch]; ///< those whose samples are in the batch

  explicit Job(int size)
      : map(size), sums(static_cast<std::size_t>(size) * static_cast<std::size_t>(size)) {}
};

MapKernel::MapKernel(const MeasuredBrdf& brdf, const ReflectionCell& cell, int supersample,
                     bool cosine)
    : m_brdf(brdf), m_supersample(supersample), m_cosine(cosine), m_normals() {
  const double theta_step = cell.theta_end - cell.theta_begin;
  const double phi_step = cell.phi_end - cell.phi_begin;
  m_cell_radius = static_cast<float>(0.5 * (theta_step + phi_step));
  m_middle =
      normal_at(cell.theta_begin + 0.5 * theta_step, cell.phi_begin + 0.5 * phi_step).cast<float>();
  for (int i = 0; i < normal_count; ++i) {
    const Eigen::Vector3d n =
        normal_at(cell.theta_begin + theta_step * (i + 0.5) / normal_count,
                  cell.phi_begin + phi_step * (radical_inverse(i) + 0.5 / normal_count));
    for (int axis = 0; axis < 3; ++axis)
      m_normals[axis][i] = static_cast<float>(n[axis]);
  }
}

/// Whether the square lies below the horizon for every normal of the cell.
bool MapKernel::below_horizon(float u, float v, float side) const {
  const Vec3 w = wavelet::square_to_sphere({u + 0.5F * side, v + 0.5F * side});
  return w.dot(m_middle) < -(radius_per_width * width_per_side * side + m_cell_radius);
}

void MapKernel::push_tile(Job& job, int tile_x, int tile_y) const {
  const int size = job.map.size;
  const float side = 1.0F / static_cast<float>(size);
  for (int y = tile_y; y < std::min(tile_y + tile_size, size); ++y) {
    for (int x = tile_x; x < std::min(tile_x + tile_size, size); ++x) {
      const auto pixel = static_cast<std::uint32_t>(y * size + x);
      const std::uint32_t bits = hash_bits(pixel);
      job.waiting.push_back({static_cast<float>(x) * side, static_cast<float>(y) * side, side,
                             static_cast<float>(bits >> 8U) * 0x1p-24F, 0.25F, pixel, bits & 3U});
    }
  }
}

/// Fills the batch with the four samples each of the squares at the end of the list.
void MapKernel::take_samples(Job& job) const {
  const auto squares = std::min<std::size_t>(job.waiting.size(), squares_per_batch);
  SampleBatch& b = job.batch;
  b.count = static_cast<int>(4 * squares);
  int i = 0;
  for (std::size_t k = 0; k < squares; ++k) {
    const Square& s = job.taken[k] = job.waiting.back();
    job.waiting.pop_back();
    for (int quarter = 0; quarter < 4; ++quarter, ++i) {
      b.u[i] = s.u + s.side * ((quarter & 1) != 0 ? 0.75F : 0.25F);
      b.v[i] = s.v + s.side * ((quarter & 2) != 0 ? 0.75F : 0.25F);
      b.spacing[i] = 0.5F * width_per_side * s.side;
      const float offset = 0.25F * (orders[s.order][quarter] + s.offset);
      // Far down the tree the offset may round to one.
      const int place = std::min(static_cast<int>(offset * normal_count), normal_count - 1);
      for (int axis = 0; axis < 3; ++axis)
        b.normal[axis][i] = m_normals[axis][place];
    }
  }
}

/// Splits the samples that are too coarse, looks the others up and adds them to their pixels.
void MapKernel::settle_samples(Job& job) const {
  SampleBatch& b = job.batch;
  const float widest = width_per_side / static_cast<float>(job.map.size * m_supersample);
  float factors[batch_capacity];
  std::uint32_t pixels[batch_capacity];
  int settled = 0;
  for (int i = 0; i < b.count; ++i) {
    const Square& s = job.taken[i / 4];
    // The samples that would replace this one have other normals.
    if (b.cosine[i] < -(radius_per_width * b.spacing[i] + 2 * m_cell_radius))
      continue;
    if (b.spacing[i] > widest * 1.001F || (b.resolution[i] > 1 && s.side > smallest_side)) {
      split(job, s, i);
    } else if (b.cosine[i] > 0) {
      if (i != settled)
        b.angles.move(i, settled);
      factors[settled] = s.weight * (m_cosine ? b.cosine[i] : 1.0F);
      pixels[settled++] = s.pixel;
    }
  }
  b.angles.count = settled;
  Float4 values[batch_capacity];
  m_brdf.evaluate(b.angles, values);
  for (int i = 0; i < settled;) {
    const std::uint32_t pixel = pixels[i];
    Float4 sum = job.sums[pixel];
    for (; i < settled && pixels[i] == pixel; ++i)
      sum += values[i] * factors[i];
    job.sums[pixel] = sum;
  }
}

/// Queues the square that sample i of the batch, one of `parent`, stands for.
void MapKernel::split(Job& job, const Square& parent, int i) {
  const float half = 0.5F * parent.side;
  job.waiting.push_back({job.batch.u[i] - 0.5F * half, job.batch.v[i] - 0.5F * half, half,
                         0.25F * (orders[parent.order][i % 4] + parent.offset),
                         0.25F * parent.weight, parent.pixel, parent.order});
}

wavelet::Map MapKernel::make(int size) const {
  Job job(size);
  Eigen::Map<Vec3>(job.batch.middle_wo) = mirror(Vec3::UnitZ(), m_middle);
  const float side = 1.0F / static_cast<float>(size);
  for (int y = 0; y < size; y += tile_size) {
    for (int x = 0; x < size; x += tile_size) {
      if (below_horizon(static_cast<float>(x) * side, static_cast<float>(y) * side,
                        side * tile_size))
        continue;
      push_tile(job, x, y);
      while (!job.waiting.empty()) {
        take_samples(job);
        place_samples(job.batch);
        settle_samples(job);
      }
    }
  }
  for (std::size_t i = 0; i < job.sums.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      job.map.rgb[3 * i + c] = job.sums[i][static_cast<int>(c)];
  return std::move(job.map);
}

} // namespace haarlight::brdf
