#pragma once
// Four floats side by side (one SSE register), and the few functions that let one template serve
// both a float and four of them with bit-identical results.

#include <cmath>
#include <cstdint>

namespace haarlight {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline float select(bool condition, float yes, float no) { return condition ? yes : no; }
inline Float4 select(Int4 condition, Float4 yes, Float4 no) { return condition ? yes : no; }

inline float square_root(float x) { return std::sqrt(x); }
inline Float4 square_root(Float4 x) {
  return Float4{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

template <class F> F broadcast(float x) { return F{} + x; }
template <class F> F absolute(F x) { return select(x < broadcast<F>(0), -x, x); }
template <class F> F larger(F a, F b) { return select(a > b, a, b); }
template <class F> F smaller(F a, F b) { return select(a < b, a, b); }

} // namespace haarlight
