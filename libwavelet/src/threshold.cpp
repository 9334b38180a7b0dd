#include <wavelet/threshold.h>

#include <wavelet/transform.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <functional>
#include <utility>

namespace haarlight::wavelet {
namespace {

constexpr std::array<std::pair<const char*, Criterion>, 4> names = {
    {{"variance", Criterion::Variance},
     {"l2", Criterion::L2},
     {"linf", Criterion::Linf},
     {"count", Criterion::Count}}};

/// Averages below this share of the map's mean are taken for it: what a sampler's floor does.
constexpr double average_floor = 0.03;

double weighted_square(const float* c) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    sum += static_cast<double>(luminance_weights[i]) * c[i] * c[i];
  return sum;
}

/// Visits every coefficient with its square's level and average luminance, coarse to fine.
class CoefficientWalk {
public:
  using Visit = std::function<void(float* coefficient, int level, double average)>;

  CoefficientWalk(Map& map, Visit visit) : m_map(map), m_visit(std::move(visit)) {}

  void run() {
    if (m_map.size > 1)
      square(0, 0, 0, luminance(m_map.at(0, 0)));
  }

private:
  void square(int level, int x, int y, double average) {
    std::array<double, 3> d = {};
    for (int m = 1; m <= 3; ++m) {
      float* c = m_map.rgb.data() + 3 * coefficient_index(m_map.size, level, x, y, m);
      d[static_cast<std::size_t>(m - 1)] = luminance(Eigen::Map<const Rgb>(c));
      m_visit(c, level, average);
    }
    if ((2 << level) >= m_map.size)
      return;
    square(level + 1, 2 * x, 2 * y, average + d[0] + d[1] + d[2]);
    square(level + 1, 2 * x + 1, 2 * y, average - d[0] + d[1] - d[2]);
    square(level + 1, 2 * x, 2 * y + 1, average + d[0] - d[1] - d[2]);
    square(level + 1, 2 * x + 1, 2 * y + 1, average - d[0] - d[1] + d[2]);
  }

  Map& m_map;
  Visit m_visit;
};

/// What ranks a coefficient: the norm of the L2-normalised wavelet's coefficient is 2^-level |d|.
double rank_of(const float* c, int level, double average, double mean, Criterion criterion) {
  const double norm = std::sqrt(weighted_square(c));
  if (criterion == Criterion::Linf)
    return std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
  const double orthonormal = std::ldexp(norm, -level);
  if (criterion != Criterion::Variance || mean <= 0)
    return orthonormal;
  return orthonormal / std::sqrt(std::max(average, average_floor * mean) * mean);
}

struct Ranked {
  double rank;
  float* coefficient;
  double energy; ///< share in ∫F²
};

std::vector<Ranked> rank_all(Map& map, Criterion criterion) {
  const double mean = luminance(map.at(0, 0));
  std::vector<Ranked> all;
  all.reserve(map.rgb.size() / 3);
  CoefficientWalk(map, [&](float* c, int level, double average) {
    const double rank = rank_of(c, level, average, mean, criterion);
    if (rank > 0)
      all.push_back({rank, c, std::ldexp(weighted_square(c), -2 * level)});
  }).run();
  return all;
}

std::size_t drop_below(std::vector<Ranked>& all, double limit) {
  std::size_t kept = 0;
  for (const Ranked& r : all) {
    if (r.rank > limit)
      ++kept;
    else
      std::fill_n(r.coefficient, 3, 0.0F);
  }
  return kept;
}

/// Highest rank first; equal ranks in place order, so that the choice never depends on the sort.
void sort_descending(std::vector<Ranked>& all) {
  std::sort(all.begin(), all.end(), [](const Ranked& a, const Ranked& b) {
    return a.rank != b.rank ? a.rank > b.rank : a.coefficient < b.coefficient;
  });
}

std::size_t keep_first(std::vector<Ranked>& all, std::size_t count) {
  sort_descending(all);
  const std::size_t kept = std::min(count, all.size());
  for (std::size_t i = kept; i < all.size(); ++i)
    std::fill_n(all[i].coefficient, 3, 0.0F);
  return kept;
}

/// Drops the smallest while the relative L2 error stays within the tolerance.
std::size_t keep_energy(std::vector<Ranked>& all, double tolerance, double mean_energy) {
  sort_descending(all);
  double energy = mean_energy;
  for (const Ranked& r : all)
    energy += r.energy;
  double budget = tolerance * tolerance * energy;
  std::size_t kept = all.size();
  while (kept > 0 && all[kept - 1].energy <= budget) {
    --kept;
    budget -= all[kept].energy;
    std::fill_n(all[kept].coefficient, 3, 0.0F);
  }
  return kept;
}

double peak_of(const Map& transformed) {
  Map pixels = transformed;
  haar_inverse(pixels.rgb.data(), pixels.size, 3);
  double peak = 0;
  for (const float value : pixels.rgb)
    peak = std::max(peak, static_cast<double>(std::abs(value)));
  return peak;
}

/// A point lies under three wavelets a level, so dropped ones of at most this size cannot add up to
/// more than the tolerance.
double linf_limit(const Map& transformed, double tolerance) {
  const int levels = std::max(1, std::countr_zero(static_cast<unsigned>(transformed.size)));
  return tolerance * peak_of(transformed) / (3.0 * levels);
}

} // namespace

std::optional<Criterion> criterion_from_name(const std::string& name) {
  for (const auto& [text, criterion] : names)
    if (name == text)
      return criterion;
  return std::nullopt;
}

std::string criterion_name(Criterion criterion) {
  return names[static_cast<std::size_t>(criterion)].first;
}

double default_tolerance(const SetInfo& info, Criterion criterion) {
  if (criterion == Criterion::L2)
    return 0.01;
  if (criterion == Criterion::Linf)
    return 0.002;
  return info.world_frame ? 0.0001 : 0.0005;
}

std::size_t apply_threshold(Map& transformed, const ThresholdOptions& options) {
  assert(options.keep || options.criterion != Criterion::Count);
  std::vector<Ranked> all = rank_all(transformed, options.criterion);
  if (options.keep)
    return keep_first(all, *options.keep);
  switch (options.criterion) {
  case Criterion::L2:
    return keep_energy(all, options.tolerance, weighted_square(transformed.rgb.data()));
  case Criterion::Linf:
    return drop_below(all, linf_limit(transformed, options.tolerance));
  default:
    return drop_below(all, options.tolerance);
  }
}

} // namespace haarlight::wavelet
