#pragma once
// The mappings of <probe/mapping.h> for a float or four lanes of them, and the choice among them
// made once per loop instead of once per point.

#include <probe/mapping.h>

#include <wavelet/square/sphere_map.h>

#include <cstdlib>

namespace haarlight::probe {

/// Least value of dω/(du dv), so that a density of directions stays finite.
inline constexpr float least_density = 1e-6F;

/// direction_and_density() of a mapping that gains nothing from finding both at once.
template <class Map>
struct ApartMap {
  template <class F>
  static void direction_and_density(F u, F v, F& x, F& y, F& z, F& density_there) {
    Map::direction(u, v, x, y, z);
    density_there = Map::density(u, v);
  }
};

struct AngularMap {
  static constexpr bool round = true;

  template <class F>
  static void direction(F u, F v, F& x, F& y, F& z) {
    F unused;
    direction_and_density(u, v, x, y, z, unused);
  }

  template <class F>
  static void direction_and_density(F u, F v, F& x, F& y, F& z, F& density_there) {
    const F one = broadcast<F>(1);
    const F a = 2.0F * u - 1.0F;
    const F b = 1.0F - 2.0F * v;
    const F r = square_root(a * a + b * b);
    F sine;
    F cosine;
    sine_cosine(smaller(r, one) * pi, sine, cosine);
    const auto off_centre = r > broadcast<F>(1e-6F);
    const F planar = select(off_centre, sine / select(off_centre, r, one), broadcast<F>(pi));
    x = a * planar;
    y = b * planar;
    z = -cosine;
    density_there = larger(4.0F * pi * planar, broadcast<F>(least_density));
  }

  template <class F>
  static void image(F x, F y, F z, F& u, F& v) {
    const F zero = broadcast<F>(0);
    const F h = square_root(x * x + y * y);
    const F r = arctangent(h, -z) * (1.0F / pi);
    const F safe = select(h > zero, h, broadcast<F>(1));
    u = 0.5F + 0.5F * (select(h > zero, x / safe, broadcast<F>(1)) * r);
    v = 0.5F - 0.5F * (y / safe * r);
  }

  template <class F>
  static F density(F u, F v) {
    F x;
    F y;
    F z;
    F result;
    direction_and_density(u, v, x, y, z, result);
    return result;
  }
};

struct LatLongMap : ApartMap<LatLongMap> {
  static constexpr bool round = false;

  template <class F>
  static void direction(F u, F v, F& x, F& y, F& z) {
    F sin_phi;
    F cos_phi;
    F sin_theta;
    sine_cosine((u - 0.5F) * (2.0F * pi), sin_phi, cos_phi);
    sine_cosine(v * pi, sin_theta, y);
    x = sin_phi * sin_theta;
    z = -cos_phi * sin_theta;
  }

  template <class F>
  static void image(F x, F y, F z, F& u, F& v) {
    u = 0.5F + arctangent(x, -z) * (0.5F / pi);
    v = arctangent(square_root(x * x + z * z), y) * (1.0F / pi);
  }

  template <class F>
  static F density(F /*u*/, F v) {
    F sine;
    F cosine;
    sine_cosine(v * pi, sine, cosine);
    return larger(2.0F * pi * pi * sine, broadcast<F>(least_density));
  }
};

struct MirrorBallMap : ApartMap<MirrorBallMap> {
  static constexpr bool round = true;

  template <class F>
  static void direction(F u, F v, F& x, F& y, F& z) {
    const F a = 2.0F * u - 1.0F;
    const F b = 1.0F - 2.0F * v;
    const F r2 = a * a + b * b;
    const F one = broadcast<F>(1);
    const F shrink = select(r2 > one, 1.0F / square_root(larger(r2, one)), one);
    const F held = smaller(r2, one);
    const F normal_z = square_root(1.0F - held);
    x = 2.0F * normal_z * a * shrink;
    y = 2.0F * normal_z * b * shrink;
    z = 1.0F - 2.0F * held;
  }

  template <class F>
  static void image(F x, F y, F z, F& u, F& v) {
    const F zero = broadcast<F>(0);
    const F h = square_root(x * x + y * y);
    // r = √((1 − z)/2), free of cancellation where the sphere faces the camera.
    const F near = h / square_root(2.0F * (1.0F + larger(z, zero)));
    const F r = select(z > zero, near, square_root(0.5F * (1.0F - smaller(z, zero))));
    const F safe = select(h > zero, h, broadcast<F>(1));
    u = 0.5F + 0.5F * (select(h > zero, x / safe, broadcast<F>(1)) * r);
    v = 0.5F - 0.5F * (y / safe * r);
  }

  template <class F>
  static F density(F /*u*/, F /*v*/) {
    return broadcast<F>(16);
  }
};

struct OctahedralMap : ApartMap<OctahedralMap> {
  static constexpr bool round = false;

  template <class F>
  static void direction(F u, F v, F& x, F& y, F& z) {
    wavelet::square_to_sphere(u, v, x, y, z);
  }
  template <class F>
  static void image(F x, F y, F z, F& u, F& v) {
    wavelet::sphere_to_square(x, y, z, u, v);
  }

  template <class F>
  static F density(F /*u*/, F /*v*/) {
    return broadcast<F>(wavelet::sphere_area);
  }
};

/// Calls body with the mapping's type.
template <class Body>
decltype(auto) with_mapping(Mapping mapping, Body&& body) {
  switch (mapping) {
  case Mapping::Angular:
    return body(AngularMap{});
  case Mapping::LatLong:
    return body(LatLongMap{});
  case Mapping::MirrorBall:
    return body(MirrorBallMap{});
  case Mapping::Octahedral:
    return body(OctahedralMap{});
  }
  std::abort();
}

} // namespace haarlight::probe
