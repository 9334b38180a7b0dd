#pragma once
// Vectors of any number of lanes, and the moves between lanes that haar_columns.h is made of.
//
// Everything has internal linkage, as transform_tile.h tells. Vectors go by reference: passed by
// value, the calling convention would depend on the instruction set.

#include <cstddef>
#include <cstring>
#include <utility>

namespace haarlight::wavelet::haar {
namespace {

template <class T, int lanes>
struct VectorOf {
  typedef T Type __attribute__((vector_size(lanes * sizeof(T))));
};
template <class T>
struct VectorOf<T, 1> {
  using Type = T;
};
template <class T, int lanes>
using Vector = typename VectorOf<T, lanes>::Type;

template <class V, class T>
void load(V& v, const T* from) {
  std::memcpy(&v, from, sizeof v);
}
template <class V, class T>
void store(T* to, const V& v) {
  std::memcpy(to, &v, sizeof v);
}

/// Lane i of `out` is lane place(i, part, lanes) of a and b, counted through.
template <int (*place)(int, int, int), int part, class Out, class In, std::size_t... i>
void merge(Out& out, const In& a, const In& b, std::index_sequence<i...>) {
  constexpr int lanes = sizeof(Out) / sizeof(a[0]);
  out = __builtin_shufflevector(a, b, place(static_cast<int>(i), part, lanes)...);
}
template <int (*place)(int, int, int), int part, class Out, class In>
void merge(Out& out, const In& a, const In& b) {
  merge<place, part>(out, a, b, std::make_index_sequence<sizeof(Out) / sizeof(a[0])>());
}

// Places that one instruction reaches at any width: within groups of four floats, or two or four
// doubles. `part` is the lower or the upper half of each group, or the even or the odd lanes.
constexpr int interleaved(int i, int part, int lanes) {
  return i / 4 * 4 + 2 * part + i / 2 % 2 + i % 2 * lanes;
}
constexpr int deinterleaved(int i, int part, int lanes) {
  return i / 4 * 4 + part + i % 2 * 2 + i / 2 % 2 * lanes;
}
constexpr int paired(int i, int part, int lanes) {
  return i / 4 * 4 + 2 * part + i % 2 + i / 2 % 2 * lanes;
}
constexpr int alternating(int i, int part, int lanes) { return i / 2 * 2 + part + i % 2 * lanes; }
constexpr int joined(int i, int /*part*/, int /*lanes*/) { return i; }

/// The two merges of a pair of vectors with one another.
template <int (*place)(int, int, int), class Lanes>
void exchange(Lanes& out0, Lanes& out1, const Lanes& a, const Lanes& b) {
  Lanes t;
  merge<place, 0>(t, a, b);
  merge<place, 1>(out1, a, b);
  out0 = t;
}

} // namespace
} // namespace haarlight::wavelet::haar
