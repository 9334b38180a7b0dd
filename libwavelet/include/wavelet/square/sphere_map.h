#pragma once
// The one map between the unit square and the sphere: octahedral equal-area (Clarberg 2008, "Fast
// equal-area mapping of the (hemi)sphere using SIMD").
//
// Square coordinates (u, v) lie in [0, 1]²; u runs with the columns of a map and v with its rows,
// row 0 first. The centre (½, ½) is local +z, the four corners are local −z, u grows towards +x and
// v towards +y. Equal area: dω = 4π du dv, hence pdf_ω = pdf_uv / 4π.

#include <wavelet/base/geometry.h>
#include <wavelet/base/trigonometry.h>

namespace haarlight::wavelet {

/// Solid angle of the whole square, steradian.
inline constexpr float sphere_area = 4.0F * pi;

/// Direction of the square point (u, v), as x, y, z; F is float or Float4.
template <class F>
void square_to_sphere(F u, F v, F& x, F& y, F& z) {
  const F zero = broadcast<F>(0);
  const F a = 2.0F * u - 1.0F;
  const F b = 2.0F * v - 1.0F;
  const F abs_a = absolute(a);
  const F abs_b = absolute(b);
  const F d = 1.0F - abs_a - abs_b;
  const F r = 1.0F - absolute(d);
  F sine;
  F cosine;
  const F turn = select(r > zero, (abs_b - abs_a) / select(r > zero, r, broadcast<F>(1)), zero);
  sine_cosine_octant(turn * (pi / 4), sine, cosine);
  const F planar = r * square_root(larger(2.0F - r * r, zero)) * 0.70710678F;
  const F px = planar * (cosine - sine);
  const F py = planar * (cosine + sine);
  x = select(a < zero, -px, px);
  y = select(b < zero, -py, py);
  const F height = 1.0F - r * r;
  z = select(d < zero, -height, height);
}

/// Square point of the unit direction (x, y, z); F is float or Float4.
template <class F>
void sphere_to_square(F x, F y, F z, F& u, F& v) {
  const F zero = broadcast<F>(0);
  const F ax = absolute(x);
  const F ay = absolute(y);
  // 1 − |z| without cancellation near the poles.
  const F r = square_root((ax * ax + ay * ay) / (1.0F + absolute(z)));
  const F sum = ax + ay;
  const F turn = arctangent_unit((ay - ax) / select(sum > zero, sum, broadcast<F>(1)));
  const F along_v = r * (0.5F + turn * (2.0F / pi));
  const F along_u = r - along_v;
  const F folded_u = select(z < zero, 1.0F - along_v, along_u);
  const F folded_v = select(z < zero, 1.0F - along_u, along_v);
  u = 0.5F + 0.5F * select(x < zero, -folded_u, folded_u);
  v = 0.5F + 0.5F * select(y < zero, -folded_v, folded_v);
}

inline Vec3 square_to_sphere(const Vec2& p) {
  Vec3 w;
  square_to_sphere(p.x(), p.y(), w.x(), w.y(), w.z());
  return w;
}

/// @param w a unit vector
inline Vec2 sphere_to_square(const Vec3& w) {
  Vec2 p;
  sphere_to_square(w.x(), w.y(), w.z(), p.x(), p.y());
  return p;
}

} // namespace haarlight::wavelet
