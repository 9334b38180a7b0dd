#pragma once
// e^x and x^p from series: the C library's functions may differ in the last bit from CPU to CPU.

#include <algorithm>
#include <cmath>
#include <numbers>

namespace haarlight::probe {

/// e^x for |x| ≤ 500; larger arguments are clamped.
inline double exponential(double x) {
  const double halvings = 64;
  const double t = std::clamp(x, -500.0, 500.0) / halvings;
  double sum = 1;
  for (int k = 18; k > 0; --k)
    sum = 1 + sum * t / k;
  for (int i = 0; i < 6; ++i)
    sum *= sum;
  return sum;
}

/// x^p for x > 0, by the series of the logarithm.
inline double power(double x, double p) {
  int exponent = 0;
  const double m = std::frexp(x, &exponent);
  const double t = (m - 0.75) / (m + 0.75);
  double sum = 0;
  double odd = t;
  for (int k = 1; k < 40; k += 2) {
    sum += odd / k;
    odd *= t * t;
  }
  constexpr double log_three_quarters = -0.28768207245178092744;
  return exponential(p * (2 * sum + log_three_quarters + exponent * std::numbers::ln2));
}

} // namespace haarlight::probe
