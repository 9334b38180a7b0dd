#include <wavelet/transform/threshold.h>

#include <wavelet/transform/transform.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

namespace haarlight::wavelet {
namespace {

/// Averages below this share of the map's mean are taken for it: what a sampler's floor does.
constexpr double average_floor = 0.03;

/// Visits every coefficient with its square's level and average luminance, coarse to fine within
/// each square. Visit: void(float* coefficient, int level, double average); it may change the
/// coefficient, which does not change the averages visited.
template <class Visit>
class CoefficientWalk {
public:
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

/// What a difference of norm 1 ranks; the norm of the L2-normalised wavelet's coefficient is
/// 2^-level |d|.
double rank_factor(int level, double average, double mean, Criterion criterion) {
  if (criterion == Criterion::Linf)
    return 1;
  const double orthonormal = std::ldexp(1.0, -level);
  if (criterion != Criterion::Variance || mean <= 0)
    return orthonormal;
  return orthonormal / std::sqrt(std::max(average, average_floor * mean) * mean);
}

/// The norm that a criterion ranks by.
double rank_norm(const float* c, Criterion criterion) {
  if (criterion == Criterion::Linf)
    return std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
  return std::sqrt(weighted_square(c));
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

std::string criterion_name(Criterion criterion) {
  constexpr std::array names = {"variance", "l2", "linf", "count"};
  return names[static_cast<std::size_t>(criterion)];
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

namespace {

/// Found by trying on seven measured BRDFs: the packed size at equal error is flat around both.
constexpr double dead_zone = 0.65;
constexpr float chroma_step = 2;

struct Triple {
  float* difference;
  int level;
};

/// A step of few binary digits, so that its products with integers are exact floats.
float step_of(int index) { return std::ldexp(static_cast<float>(128 + (index & 127)), index >> 7); }

Rgb rounded(const Rgb& c, float step) {
  const Rgb u = c / step;
  if (weighted_square(u.data()) <= dead_zone * dead_zone)
    return Rgb::Zero();
  const float green = std::nearbyint(u[1]);
  const auto chroma = [&](float value) {
    return green + chroma_step * std::nearbyint((value - green) / chroma_step);
  };
  return step * Rgb(chroma(u[0]), green, chroma(u[2]));
}

/// Rounds all triples of a map with one step.
class UniformRounding {
public:
  explicit UniformRounding(Map& map) {
    const auto visit = [&](float* c, int level, double) {
      const double square = std::ldexp(weighted_square(c), -2 * level);
      if (square > 0)
        m_triples.push_back({c, level});
      m_energy += square;
    };
    CoefficientWalk(map, visit).run();
    m_energy += weighted_square(map.rgb.data());
  }

  double energy() const { return m_energy; }

  double squared_error(float step) const {
    double sum = 0;
    for (const Triple& t : m_triples) {
      const Rgb c = Eigen::Map<const Rgb>(t.difference);
      const Rgb error = c - rounded(c, std::ldexp(step, t.level));
      sum += std::ldexp(weighted_square(error.data()), -2 * t.level);
    }
    return sum;
  }

  std::size_t apply(float step) const {
    std::size_t kept = 0;
    for (const Triple& t : m_triples) {
      Eigen::Map<Rgb> c(t.difference);
      c = rounded(c, std::ldexp(step, t.level));
      kept += c.isZero(0) ? 0 : 1;
    }
    return kept;
  }

private:
  std::vector<Triple> m_triples;
  double m_energy = 0;
};

/// The largest step within the tolerance, by bisection; the error hardly ever falls as the step
/// grows.
Quantized round_to_tolerance(Map& transformed, double tolerance) {
  const UniformRounding rounding(transformed);
  const double budget = tolerance * tolerance * rounding.energy();
  const int scale_exponent = static_cast<int>(std::ceil(std::log2(std::sqrt(rounding.energy()))));
  int high = 128 * (scale_exponent + 2 - 7);
  int low = high - 128 * 32;
  if (!(budget > 0) || rounding.squared_error(step_of(low)) > budget)
    return {apply_threshold(transformed, {Criterion::L2, tolerance, std::nullopt}).coefficients, 0};
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (rounding.squared_error(step_of(middle)) <= budget ? low : high) = middle;
  }
  const int levels = std::countr_zero(static_cast<unsigned>(transformed.size));
  return {rounding.apply(step_of(low)), std::ldexp(step_of(low), levels - 1)};
}

/// The power of two at or below a positive number.
float power_below(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return static_cast<float>(std::ldexp(1.0, exponent - 1));
}

std::size_t round_to_limit(Map& transformed, Criterion criterion, double limit) {
  const double mean = luminance(transformed.at(0, 0));
  std::size_t kept = 0;
  const auto visit = [&](float* c, int level, double average) {
    const float step = power_below(2 * limit / rank_factor(level, average, mean, criterion));
    Eigen::Map<Rgb> colour(c);
    for (float& value : colour)
      value = step * std::nearbyint(value / step);
    kept += colour.isZero(0) ? 0 : 1;
  };
  CoefficientWalk(transformed, visit).run();
  return kept;
}

} // namespace

Quantized apply_quantization(Map& transformed, const ThresholdOptions& options) {
  if (options.criterion == Criterion::L2 && !options.keep)
    return round_to_tolerance(transformed, options.tolerance);
  const Kept kept = apply_threshold(transformed, options);
  if (kept.limit <= 0)
    return {kept.coefficients, 0};
  return {round_to_limit(transformed, options.criterion, kept.limit), 0};
}

} // namespace haarlight::wavelet
