#pragma once
// Eight floats side by side (one AVX register), for code that is compiled for AVX2 and entered only
// where the CPU has it. As the lanes of <wavelet/base/lanes.h>, each computes what a float would,
// bit for bit; a class, so that those templates find these operators.
//
// Everything is inlined: as function arguments such registers have no agreed place without AVX.

#include <wavelet/base/lanes.h>

namespace haarlight::probe {

using Raw8 = float __attribute__((vector_size(32)));
using Int8 = std::int32_t __attribute__((vector_size(32)));

#define HAARLIGHT_INLINE [[gnu::always_inline]] inline

struct Mask8 {
  Int8 lanes;
};

struct Float8 {
  Raw8 lanes;

  HAARLIGHT_INLINE Float8() : lanes{} {}
  HAARLIGHT_INLINE explicit Float8(Raw8 values) : lanes(values) {}

  HAARLIGHT_INLINE friend Float8 operator+(Float8 a, Float8 b) { return Float8(a.lanes + b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator-(Float8 a, Float8 b) { return Float8(a.lanes - b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator*(Float8 a, Float8 b) { return Float8(a.lanes * b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator/(Float8 a, Float8 b) { return Float8(a.lanes / b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator+(Float8 a, float b) { return Float8(a.lanes + b); }
  HAARLIGHT_INLINE friend Float8 operator-(Float8 a, float b) { return Float8(a.lanes - b); }
  HAARLIGHT_INLINE friend Float8 operator*(Float8 a, float b) { return Float8(a.lanes * b); }
  HAARLIGHT_INLINE friend Float8 operator/(Float8 a, float b) { return Float8(a.lanes / b); }
  HAARLIGHT_INLINE friend Float8 operator+(float a, Float8 b) { return Float8(a + b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator-(float a, Float8 b) { return Float8(a - b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator*(float a, Float8 b) { return Float8(a * b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator/(float a, Float8 b) { return Float8(a / b.lanes); }
  HAARLIGHT_INLINE friend Float8 operator-(Float8 a) { return Float8(-a.lanes); }
  HAARLIGHT_INLINE friend Mask8 operator<(Float8 a, Float8 b) { return {a.lanes < b.lanes}; }
  HAARLIGHT_INLINE friend Mask8 operator>(Float8 a, Float8 b) { return {a.lanes > b.lanes}; }
};

HAARLIGHT_INLINE Float8 select(Mask8 condition, Float8 yes, Float8 no) {
  return Float8(condition.lanes ? yes.lanes : no.lanes);
}

HAARLIGHT_INLINE Float8 square_root(Float8 x) {
  Raw8 roots;
  for (int i = 0; i < 8; ++i)
    roots[i] = std::sqrt(x.lanes[i]);
  return Float8(roots);
}

/// 0, 1, 2 … one for each lane.
template <class F>
F lane_numbers();
template <>
HAARLIGHT_INLINE Float4 lane_numbers<Float4>() {
  return Float4{0, 1, 2, 3};
}
template <>
HAARLIGHT_INLINE Float8 lane_numbers<Float8>() {
  return Float8(Raw8{0, 1, 2, 3, 4, 5, 6, 7});
}

/// The lanes as integers, rounded towards 0.
HAARLIGHT_INLINE Int4 truncated(Float4 x) { return __builtin_convertvector(x, Int4); }
HAARLIGHT_INLINE Int8 truncated(Float8 x) { return __builtin_convertvector(x.lanes, Int8); }

#undef HAARLIGHT_INLINE

} // namespace haarlight::probe
