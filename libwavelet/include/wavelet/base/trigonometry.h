#pragma once
// Polynomial trigonometry for a float or four lanes of them. The C library selects code by CPU and
// so rounds differently from machine to machine; these give the same bits everywhere.
// elementary.h has slower functions in double with errors of 1e-14.
// Errors are absolute, in radians where the result is an angle.

#include <wavelet/base/lanes.h>

#include <numbers>

namespace haarlight {

inline constexpr float pi = std::numbers::pi_v<float>;

/// Angle of the tangent t, |t| ≤ 1. Error below 1e-7.
template <class F>
F arctangent_unit(F t) {
  const F z = t * t;
  F p = z * 2.766283501e-03F - 1.573124912e-02F;
  p = p * z + 4.213762359e-02F;
  p = p * z - 7.456854826e-02F;
  p = p * z + 1.061837064e-01F;
  p = p * z - 1.419779779e-01F;
  p = p * z + 1.999187203e-01F;
  p = p * z - 3.333303671e-01F;
  p = p * z + 9.999999818e-01F;
  return p * t;
}

/// Sine and cosine of an angle in [−π/4, π/4]. Error below 1e-7.
template <class F>
void sine_cosine_octant(F angle, F& sine, F& cosine) {
  const F z = angle * angle;
  sine = (((z * -1.950390425e-04F + 8.332035786e-03F) * z - 1.666665067e-01F) * z + 1.0F) * angle;
  cosine =
      (((z * 2.437983124e-05F - 1.388661800e-03F) * z + 4.166661669e-02F) * z - 0.5F) * z + 1.0F;
}

/// Angle of the point (x, y) from the x axis, in (−π, π]; 0 at the origin. Error below 4e-7.
template <class F>
F arctangent(F y, F x) {
  const F zero = broadcast<F>(0);
  const F ax = absolute(x);
  const F ay = absolute(y);
  const F low = smaller(ax, ay);
  const F high = larger(ax, ay);
  const F unit = arctangent_unit(low / select(high > zero, high, broadcast<F>(1)));
  const F first = select(ay > ax, 0.5F * pi - unit, unit);
  const F upper = select(x < zero, pi - first, first);
  return select(y < zero, -upper, upper);
}

/// Angle whose cosine is x, in [0, π]; x is clamped to [−1, 1]. Error below 4e-7, but next to
/// |x| = 1, where float itself resolves no better than 3e-4.
template <class F>
F arccosine(F x) {
  const F one = broadcast<F>(1);
  const F c = smaller(larger(x, -one), one);
  return arctangent(square_root((one - c) * (one + c)), c);
}

/// Sine and cosine of any angle within a few turns. Error below 5e-7.
template <class F>
void sine_cosine(F angle, F& sine, F& cosine) {
  const F zero = broadcast<F>(0);
  const F quarters = angle * (2.0F / pi);
  const F rounder = select(quarters < zero, broadcast<F>(-12582912.0F), broadcast<F>(12582912.0F));
  const F k = (quarters + rounder) - rounder;
  F s;
  F c;
  sine_cosine_octant((angle - k * 1.5707962513F) - k * 7.5497894159e-8F, s, c);
  const F half = k * 0.5F;
  const F odd = absolute(k - 2.0F * ((half + rounder) - rounder));
  const F quarter_rounder = k * 0.25F;
  const F m = k - 4.0F * ((quarter_rounder + rounder) - rounder); // in [−2, 2]
  const F swapped_s = select(odd > broadcast<F>(0.5F), c, s);
  const F swapped_c = select(odd > broadcast<F>(0.5F), s, c);
  const F size = absolute(m);
  sine = select((size > broadcast<F>(1.5F)), -swapped_s,
                select(m < broadcast<F>(-0.5F), -swapped_s, swapped_s));
  cosine = select(size > broadcast<F>(1.5F), -swapped_c,
                  select(m > broadcast<F>(0.5F), -swapped_c, swapped_c));
}

} // namespace haarlight
