#pragma once
// The coefficients of a transformed map one by one, with what ranks them.

#include <wavelet/transform/threshold.h>
#include <wavelet/transform/transform.h>
#include <wavelet/tree/map_set.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace haarlight::wavelet {

/// Averages below this share of the map's mean are taken for it: what a sampler's floor does.
inline constexpr double average_floor = 0.03;

/// Σ w c², w the luminance weights.
inline double weighted_square(const float* c) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    sum += static_cast<double>(luminance_weights[i]) * c[i] * c[i];
  return sum;
}

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
inline double rank_factor(int level, double average, double mean, Criterion criterion) {
  if (criterion == Criterion::Linf)
    return 1;
  const double orthonormal = std::ldexp(1.0, -level);
  if (criterion != Criterion::Variance || mean <= 0)
    return orthonormal;
  return orthonormal / std::sqrt(std::max(average, average_floor * mean) * mean);
}

/// The norm that a criterion ranks by.
inline double rank_norm(const float* c, Criterion criterion) {
  if (criterion == Criterion::Linf)
    return std::max({std::abs(c[0]), std::abs(c[1]), std::abs(c[2])});
  return std::sqrt(weighted_square(c));
}

} // namespace haarlight::wavelet
