#pragma once
// Elementary functions in double that round alike on every CPU (the C library picks its code by
// CPU), and the angles of a MERL table's bin centres. Relative errors stay below 1e-14.

#include <brdf/merl_file.h>

#include <cmath>
#include <numbers>

namespace haarlight::brdf {

struct SineCosine {
  double sine;
  double cosine;
};

/// Of an angle in [−8, 8].
inline SineCosine sine_cosine(double angle) {
  constexpr double quarter_high = 1.5707963267341256;   // π/2 to 33 bits
  constexpr double quarter_low = 6.077100506506192e-11; // and the rest
  const int turns = static_cast<int>(angle / quarter_high + (angle < 0 ? -0.5 : 0.5));
  const double x = (angle - turns * quarter_high) - turns * quarter_low;
  double sine = 1;
  double cosine = 1;
  for (int i = 20; i >= 2; i -= 2) { // Horner's form of both Taylor series
    cosine = 1 - x * x / (i * (i - 1)) * cosine;
    sine = 1 - x * x / (i * (i + 1)) * sine;
  }
  sine *= x;
  switch (turns & 3) {
  case 0:
    return {sine, cosine};
  case 1:
    return {cosine, -sine};
  case 2:
    return {-sine, -cosine};
  default:
    return {-cosine, sine};
  }
}

/// e^x for x ≤ 700; 0 below −700.
inline double exponential(double x) {
  constexpr double ln2_high = 0.6931471803691238;    // ln 2 to 32 bits
  constexpr double ln2_low = 1.9082149292705877e-10; // and the rest
  if (x < -700)
    return 0;
  const int k = static_cast<int>(x / ln2_high + (x < 0 ? -0.5 : 0.5));
  const double r = (x - k * ln2_high) - k * ln2_low;
  double sum = 1;
  for (int i = 14; i >= 1; --i)
    sum = 1 + r / i * sum;
  return std::ldexp(sum, k);
}

/// ln x for x > 0.
inline double logarithm(double x) {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < std::numbers::sqrt2 / 2) {
    mantissa *= 2;
    --exponent;
  }
  const double s = (mantissa - 1) / (mantissa + 1);
  double sum = 0;
  for (int i = 23; i >= 1; i -= 2)
    sum = sum * s * s + 1.0 / i;
  return 2 * s * sum + exponent * std::numbers::ln2;
}

/// x^y for x ≥ 0 and y > 0.
inline double power(double x, double y) { return x > 0 ? exponential(y * logarithm(x)) : 0; }

/// Angles of bin centres, radians.
inline double theta_h_centre(int bin) {
  const double root = (bin + 0.5) / merl_theta_h_bins;
  return root * root * (std::numbers::pi / 2);
}
inline double theta_d_centre(int bin) {
  return (bin + 0.5) / merl_theta_d_bins * (std::numbers::pi / 2);
}
/// For either number of bins: both have one per degree.
inline double phi_d_centre(int bin) { return (bin + 0.5) / merl_phi_d_bins * std::numbers::pi; }

} // namespace haarlight::brdf
