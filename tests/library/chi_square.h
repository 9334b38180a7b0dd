#pragma once
// Whether samples follow the density they claim: Pearson's chi-squared over a grid on the unit
// square.

#include <wavelet/base/geometry.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

struct ChiSquareResult {
  double statistic = 0;
  int degrees = 0;
  double limit = 0;   ///< exceeded by chance once in about 10⁶
  double pdf_sum = 0; ///< ∫ pdf over the square: 1 if the pdf is normalised
};

/// @param draw a point of the square from its index; @param pdf per unit square
inline ChiSquareResult chi_square(int samples, int cells, int taps,
                                  const std::function<haarlight::Vec2(int)>& draw,
                                  const std::function<double(haarlight::Vec2)>& pdf) {
  const auto count = static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells);
  std::vector<double> expected(count);
  std::vector<double> observed(count);
  const int side = cells * taps;
  ChiSquareResult result;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const haarlight::Vec2 p((static_cast<float>(x) + 0.5F) / static_cast<float>(side),
                              (static_cast<float>(y) + 0.5F) / static_cast<float>(side));
      const double mass = pdf(p) / (static_cast<double>(side) * side);
      result.pdf_sum += mass;
      expected[static_cast<std::size_t>(y / taps * cells + x / taps)] += samples * mass;
    }
  for (int i = 0; i < samples; ++i) {
    const haarlight::Vec2 p = draw(i);
    const int x = std::min(cells - 1, static_cast<int>(p.x() * static_cast<float>(cells)));
    const int y = std::min(cells - 1, static_cast<int>(p.y() * static_cast<float>(cells)));
    observed[static_cast<std::size_t>(y * cells + x)] += 1;
  }
  double rare_expected = 0; // cells that expect few samples count together
  double rare_observed = 0;
  const auto add = [&](double e, double o) {
    result.statistic += (o - e) * (o - e) / e;
    ++result.degrees;
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (expected[i] >= 10) {
      add(expected[i], observed[i]);
    } else {
      rare_expected += expected[i];
      rare_observed += observed[i];
    }
  }
  if (rare_expected > 0.5)
    add(rare_expected, rare_observed);
  else
    result.statistic += rare_observed * 1000; // samples where the density says there are none
  const double n = std::max(1, result.degrees - 1);
  result.limit =
      n * std::pow(1 - 2 / (9 * n) + 4.75 * std::sqrt(2 / (9 * n)), 3); // Wilson and Hilferty
  return result;
}
