#include <wavelet/transform/threshold.h>

#include "transform/coefficient_walk.h"

#include <wavelet/transform/transform.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

namespace haarlight::wavelet {
namespace {

constexpr std::array<std::pair<const char*, Criterion>, 4> names = {
    {{"variance", Criterion::Variance},
     {"l2", Criterion::L2},
     {"linf", Criterion::Linf},
     {"count", Criterion::Count}}};

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
    const double rank = rank_norm(c, criterion) * rank_factor(level, average, mean, criterion);
    if (rank > 0)
      all.push_back({rank, c, std::ldexp(weighted_square(c), -2 * level)});
  }).run();
  return all;
}

Kept drop_below(std::vector<Ranked>& all, double limit) {
  std::size_t kept = 0;
  for (const Ranked& r : all) {
    if (r.rank > limit)
      ++kept;
    else
      std::fill_n(r.coefficient, 3, 0.0F);
  }
  return {kept, limit};
}

/// Highest rank first; equal ranks in place order, so that the choice never depends on the sort.
void sort_descending(std::vector<Ranked>& all) {
  std::sort(all.begin(), all.end(), [](const Ranked& a, const Ranked& b) {
    return a.rank != b.rank ? a.rank > b.rank : a.coefficient < b.coefficient;
  });
}

Kept keep_first(std::vector<Ranked>& all, std::size_t count) {
  sort_descending(all);
  const std::size_t kept = std::min(count, all.size());
  for (std::size_t i = kept; i < all.size(); ++i)
    std::fill_n(all[i].coefficient, 3, 0.0F);
  return {kept, kept < all.size() ? all[kept].rank : 0};
}

/// Drops the smallest while the relative L2 error stays within the tolerance.
Kept keep_energy(std::vector<Ranked>& all, double tolerance, double mean_energy) {
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
  return {kept, kept < all.size() ? all[kept].rank : 0};
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

Kept apply_threshold(Map& transformed, const ThresholdOptions& options) {
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
