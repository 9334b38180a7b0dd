#pragma once
// Four floats in one vector, by GCC vector extensions, and the functions that let one template
// serve a float and four of them with bit-identical results. With HAARLIGHT_CPU_CLONES on wide
// loops (cpu_clones.h) this is how SIMD code is written here.

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace haarlight {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

/// Vectors from and to memory of any alignment.
template <class V, class T>
V load_lanes(const T* from) {
  V result;
  std::memcpy(&result, from, sizeof result);
  return result;
}
template <class V, class T>
void store_lanes(T* to, const V& value) {
  std::memcpy(to, &value, sizeof value);
}

inline float select(bool condition, float yes, float no) { return condition ? yes : no; }
inline Float4 select(Int4 condition, Float4 yes, Float4 no) { return condition ? yes : no; }

inline float square_root(float x) { return std::sqrt(x); }
inline Float4 square_root(Float4 x) {
  return Float4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

/// Four rows of four to four columns.
inline void transpose(Float4& a, Float4& b, Float4& c, Float4& d) {
  const Float4 ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5);
  const Float4 ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Float4 cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5);
  const Float4 cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

/// The sums of the lanes of a, b and c; lane 3 is 0.
inline Float4 lane_sums(Float4 a, Float4 b, Float4 c) {
  const Float4 zero = {};
  const Float4 ab =
      __builtin_shufflevector(a, b, 0, 4, 1, 5) + __builtin_shufflevector(a, b, 2, 6, 3, 7);
  const Float4 c0 =
      __builtin_shufflevector(c, zero, 0, 4, 1, 5) + __builtin_shufflevector(c, zero, 2, 6, 3, 7);
  return __builtin_shufflevector(ab, c0, 0, 1, 4, 5) + __builtin_shufflevector(ab, c0, 2, 3, 6, 7);
}

/// 2^exponent, −126 ≤ exponent ≤ 127.
inline float power_of_two(int exponent) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(exponent + 127) << 23U);
}

template <class F>
F broadcast(float x) {
  return F{} + x;
}
template <class F>
F absolute(F x) {
  return select(x < broadcast<F>(0), -x, x);
}
template <class F>
F larger(F a, F b) {
  return select(a > b, a, b);
}
#ifdef __SSE__
/// g++ 12 does not compile the template to this instruction.
inline Float4 larger(Float4 a, Float4 b) { return __builtin_ia32_maxps(a, b); }
#endif
template <class F>
F smaller(F a, F b) {
  return select(a < b, a, b);
}

} // namespace haarlight
