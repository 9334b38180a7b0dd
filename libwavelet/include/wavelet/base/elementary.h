#pragma once
// Elementary functions in double precision from series. The C library selects code by CPU and so
// rounds differently from machine to machine; these give the same bits everywhere. Relative errors
// stay below 1e-14. For set-up work and tables: trigonometry.h has the faster float versions, for
// one number or for lanes, with errors of about 1e-7.

#include <algorithm>
#include <cmath>
#include <numbers>

namespace haarlight {

struct SineCosine {
  double sine = 0;
  double cosine = 1;
};

/// The sine and cosine of an angle plus a number of quarter turns.
inline SineCosine add_quarter_turns(const SineCosine& s, int quarters) {
  switch (quarters & 3) {
  case 0:
    return s;
  case 1:
    return {s.cosine, -s.sine};
  case 2:
    return {-s.sine, -s.cosine};
  default:
    return {-s.cosine, s.sine};
  }
}

/// @param angle radians, in [−8, 8]
inline SineCosine sine_cosine(double angle) {
  constexpr double quarter_high = 1.5707963267341256;   // π/2 to 33 bits
  constexpr double quarter_low = 6.077100506506192e-11; // and the rest
  const int quarters = static_cast<int>(angle / quarter_high + (angle < 0 ? -0.5 : 0.5));
  const double x = (angle - quarters * quarter_high) - quarters * quarter_low;
  double sine = 1;
  double cosine = 1;
  for (int i = 20; i >= 2; i -= 2) { // Horner's form of both Taylor series
    cosine = 1 - x * x / (i * (i - 1)) * cosine;
    sine = 1 - x * x / (i * (i + 1)) * sine;
  }
  return add_quarter_turns({sine * x, cosine}, quarters);
}

/// Of any finite angle in degrees; exact at multiples of 90.
inline SineCosine sine_cosine_degrees(double degrees) {
  const double angle = std::fmod(degrees, 360.0); // exact
  const double quarters = std::nearbyint(angle / 90.0);
  return add_quarter_turns(sine_cosine((angle - 90.0 * quarters) * (std::numbers::pi / 180.0)),
                           static_cast<int>(quarters));
}

/// e^x; 0 below −700, and e^709 (8e307) above 709.
inline double exponential(double x) {
  constexpr double ln2_high = 0.6931471803691238;    // ln 2 to 32 bits
  constexpr double ln2_low = 1.9082149292705877e-10; // and the rest
  if (x < -700 || std::isnan(x))
    return x < 0 ? 0 : x;
  const double held = std::min(x, 709.0);
  const int k = static_cast<int>(held / ln2_high + (held < 0 ? -0.5 : 0.5));
  const double r = (held - k * ln2_high) - k * ln2_low;
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

/// x^y for x > 0; 0 for x ≤ 0.
inline double power(double x, double y) { return x > 0 ? exponential(y * logarithm(x)) : 0; }

} // namespace haarlight
