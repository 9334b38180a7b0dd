#include <info/page.h>

#include <wavelet/base/parallel.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>

namespace haarlight::info {
namespace {

using wavelet::MapPlace;
using wavelet::TreeSet;
using wavelet::TreeView;

constexpr unsigned mantissa_bits = 23;
constexpr unsigned bin_shift = 17; ///< 64 bins per octave

/// Energies by size. All energies of a bin have the same exponent, so that their sum is a sum of
/// integers, which does not depend on the order.
class Histogram {
public:
  /// @param energy finite, ≥ 0
  void add(float energy) {
    const auto bits = std::bit_cast<std::uint32_t>(energy);
    if (bits == 0)
      return;
    const std::uint32_t implicit = bits >> mantissa_bits != 0 ? 1U << mantissa_bits : 0U;
    Bin& bin = m_bins[bits >> bin_shift];
    ++bin.count;
    bin.mantissas += (bits & ((1U << mantissa_bits) - 1U)) + implicit;
  }

  void add(const Histogram& other) {
    for (std::size_t i = 0; i < m_bins.size(); ++i) {
      m_bins[i].count += other.m_bins[i].count;
      m_bins[i].mantissas += other.m_bins[i].mantissas;
    }
  }

  /// Number of bins, ordered by increasing energy.
  std::size_t size() const { return m_bins.size(); }
  std::uint64_t count(std::size_t bin) const { return m_bins[bin].count; }
  double energy(std::size_t bin) const {
    const int exponent = std::max(1, static_cast<int>(bin >> (mantissa_bits - bin_shift)));
    return std::ldexp(static_cast<double>(m_bins[bin].mantissas), exponent - 150);
  }

private:
  struct Bin {
    std::uint64_t count = 0;
    std::uint64_t mantissas = 0;
  };
  std::vector<Bin> m_bins = std::vector<Bin>(std::size_t{1} << (31 - bin_shift));
};

/// A power of two that scales the trees' coefficients to a range in which their squares do not
/// overflow. The curve is relative, so it does not depend on this factor.
float common_scale(const TreeSet& set, const std::vector<MapPlace>& trees) {
  constexpr int largest_exponent = 126;
  float largest = 0;
  for (const MapPlace& place : trees)
    largest = std::max(largest, set.tree(place.column, place.row).mean.abs().maxCoeff());
  if (!(largest > 0))
    return 1;
  return std::ldexp(1.0F, std::clamp(-std::ilogb(largest), -largest_exponent, largest_exponent));
}

float weighted_square(Float4 c) { return wavelet::lane_sum(c * c * wavelet::luminance_lanes); }

Histogram energy_histogram(const TreeSet& set, MapPlace place, float scale) {
  const TreeView& tree = set.tree(place.column, place.row);
  Histogram histogram;
  std::uint32_t node = 0;
  for (int level = 0; level < set.levels(); ++level)
    for (auto left = set.level_nodes(place.column, place.row, level); left > 0; --left) {
      const wavelet::Details details = tree.details(node++);
      for (const Float4 d : {details.d1, details.d2, details.d3})
        histogram.add(std::ldexp(weighted_square(scale * d), -2 * level));
    }
  return histogram;
}

Histogram energy_histogram(const TreeSet& set, const std::vector<MapPlace>& trees, float scale) {
  Histogram sum;
  std::mutex mutex;
  parallel_for(trees.size(), [&](std::size_t i) {
    const Histogram one = energy_histogram(set, trees[i], scale);
    const std::scoped_lock lock(mutex);
    sum.add(one);
  });
  return sum;
}

double energy_of_means(const TreeSet& set, const std::vector<MapPlace>& trees, float scale) {
  double energy = 0;
  for (const MapPlace& place : trees)
    energy += static_cast<double>(
        weighted_square(scale * wavelet::to_lanes(set.tree(place.column, place.row).mean)));
  return energy;
}

/// Absolute squared error if a bin and all bins above it are kept, by decreasing error.
std::vector<KeptPoint> all_points(const Histogram& histogram) {
  std::vector<KeptPoint> points;
  double dropped = 0;
  std::uint64_t total = 0;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
    if (histogram.count(bin) == 0)
      continue;
    points.push_back({total, dropped});
    dropped += histogram.energy(bin);
    total += histogram.count(bin);
  }
  for (KeptPoint& point : points)
    point.kept = total - point.kept;
  std::reverse(points.begin(), points.end());
  return points;
}

} // namespace

std::vector<KeptPoint> error_curve(const TreeSet& set, const std::vector<MapPlace>& trees) {
  const float scale = common_scale(set, trees);
  const Histogram histogram = energy_histogram(set, trees, scale);
  double energy = energy_of_means(set, trees, scale);
  for (std::size_t bin = 0; bin < histogram.size(); ++bin)
    energy += histogram.energy(bin);
  std::vector<KeptPoint> curve;
  for (const KeptPoint& point : all_points(histogram))
    if (curve.empty() || point.error == 0 ||
        static_cast<double>(point.kept) > 1.12 * static_cast<double>(curve.back().kept))
      curve.push_back({point.kept, std::sqrt(point.error / energy)});
  return curve;
}

} // namespace haarlight::info
