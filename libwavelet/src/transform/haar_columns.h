#pragma once
// Four neighbouring columns of one row of pixels, as vectors that hold one of the columns each:
// what haar_tile.h lifts. A lane is a pixel of another 4 × 4 block (PlanarColumns), a channel of
// one block (AnyColumns), or both (RgbColumns). Only moves are done here: no width rounds
// differently.

#include "transform/haar_lanes.h"

namespace haarlight::wavelet::haar {
namespace {

/// One channel: `lanes` blocks side by side. In a loaded row x[0] and x[1] hold the even and the
/// odd columns of half of the blocks, x[2] and x[3] those of the other half; split() makes x[0] and
/// x[2] the first and the third columns of all. Block r · lanes / 4 + g then lies in lane 4g + r.
template <class T, int lanes>
struct PlanarColumns {
  using Lanes = Vector<T, lanes>;
  static constexpr int blocks = lanes;

  static void load_row(Lanes (&x)[4], const T* row, std::size_t /*channels*/) {
    Lanes t[4];
    load(t[0], row);
    load(t[1], row + lanes);
    load(t[2], row + 2 * lanes);
    load(t[3], row + 3 * lanes);
    exchange<to_columns>(x[0], x[1], t[0], t[1]);
    exchange<to_columns>(x[2], x[3], t[2], t[3]);
  }
  static void store_row(T* row, const Lanes (&x)[4], std::size_t /*channels*/) {
    Lanes t[4];
    exchange<to_row>(t[0], t[1], x[0], x[1]);
    exchange<to_row>(t[2], t[3], x[2], x[3]);
    store(row, t[0]);
    store(row + lanes, t[1]);
    store(row + 2 * lanes, t[2]);
    store(row + 3 * lanes, t[3]);
  }
  static void split(Lanes& x0, Lanes& x2) { exchange<to_fourths>(x0, x2, x0, x2); }
  static void join(Lanes& x0, Lanes& x2) { exchange<to_halves>(x0, x2, x0, x2); }

  static std::size_t parking(int column, std::size_t /*channels*/) {
    return static_cast<std::size_t>(column) * lanes;
  }
  static void load_averages(Lanes& x, const T* averages) {
    load(x, averages);
    if constexpr (lanes > 4)
      merge<lane_of_place, 0>(x, x, x);
  }
  static void store_averages(T* averages, const Lanes& x) {
    Lanes t = x;
    if constexpr (lanes > 4)
      merge<place_of_lane, 0>(t, x, x);
    store(averages, t);
  }

private:
  static constexpr bool narrow = sizeof(T) == 4;
  static constexpr auto to_columns = narrow ? deinterleaved : alternating;
  static constexpr auto to_row = narrow ? interleaved : alternating;
  static constexpr auto to_fourths = narrow ? deinterleaved : lanes == 2 ? alternating : paired;
  static constexpr auto to_halves = narrow ? interleaved : lanes == 2 ? alternating : paired;

  static constexpr int lane_of_place(int i, int /*part*/, int n) { return i % 4 * (n / 4) + i / 4; }
  static constexpr int place_of_lane(int i, int /*part*/, int n) {
    return i % (n / 4) * 4 + i / (n / 4);
  }
};

/// Three interleaved channels: lanes / 4 blocks side by side, the fourth lane of each idle.
template <class T, int lanes>
struct RgbColumns {
  using Lanes = Vector<T, lanes>;
  static constexpr int blocks = lanes / 4;

  static void load_row(Lanes (&x)[4], const T* row, std::size_t /*channels*/) {
    gather<12>(x[0], row);
    gather<12>(x[1], row + 3);
    gather<12>(x[2], row + 6);
    gather<12>(x[3], row + 8); // ends where the block ends
    merge<next_lane, 0>(x[3], x[3], x[3]);
  }
  static void store_row(T* row, const Lanes (&x)[4], std::size_t /*channels*/) {
    Lanes t[3];
    merge<packed, 0>(t[0], x[0], x[1]);
    merge<packed, 1>(t[1], x[1], x[2]);
    merge<packed, 2>(t[2], x[2], x[3]);
    scatter<12>(row, t[0]);
    scatter<12>(row + 4, t[1]);
    scatter<12>(row + 8, t[2]);
  }
  static void split(Lanes& /*x0*/, Lanes& /*x2*/) {}
  static void join(Lanes& /*x0*/, Lanes& /*x2*/) {}

  static std::size_t parking(int column, std::size_t /*channels*/) {
    return static_cast<std::size_t>(column - 1) * lanes;
  }
  static void load_averages(Lanes& x, const T* averages) { gather<3>(x, averages); }
  /// Writes one element past the last block.
  static void store_averages(T* averages, const Lanes& x) { scatter<3>(averages, x); }

private:
  static constexpr std::size_t group = 4 * sizeof(T); ///< bytes

  static constexpr int next_lane(int i, int /*part*/, int /*lanes*/) {
    return i % 4 == 3 ? i : i + 1;
  }
  /// Four of the twelve channels of four pixels, from the `part` quarter on, out of pixels `part`
  /// and `part` + 1.
  static constexpr int packed(int i, int part, int n) {
    const int channel = 4 * part + i % 4;
    return i / 4 * 4 + channel % 3 + (channel / 3 == part ? 0 : n);
  }

  /// Groups of four from places `step` apart, joined in halves.
  template <int step, class V>
  static void gather(V& v, const T* from) {
    if constexpr (sizeof(V) == group) {
      load(v, from);
    } else {
      constexpr int n = sizeof(V) / sizeof(T) / 2;
      Vector<T, n> halves[2];
      gather<step>(halves[0], from);
      gather<step>(halves[1], from + n / 4 * step);
      merge<joined, 0>(v, halves[0], halves[1]);
    }
  }
  template <int step, class V>
  static void scatter(T* to, const V& v) {
    for (std::size_t i = 0; i < lanes / 4; ++i)
      std::memcpy(to + i * step, reinterpret_cast<const char*>(&v) + group * i, group);
  }
};

/// `lanes` neighbouring ones of any number of interleaved channels, of one block.
template <class T, int lanes>
struct AnyColumns {
  using Lanes = Vector<T, lanes>;
  static constexpr int blocks = 1;

  static void load_row(Lanes (&x)[4], const T* row, std::size_t channels) {
    load(x[0], row);
    load(x[1], row + channels);
    load(x[2], row + 2 * channels);
    load(x[3], row + 3 * channels);
  }
  static void store_row(T* row, const Lanes (&x)[4], std::size_t channels) {
    store(row, x[0]);
    store(row + channels, x[1]);
    store(row + 2 * channels, x[2]);
    store(row + 3 * channels, x[3]);
  }
  static void split(Lanes& /*x0*/, Lanes& /*x2*/) {}
  static void join(Lanes& /*x0*/, Lanes& /*x2*/) {}

  static std::size_t parking(int column, std::size_t channels) {
    return static_cast<std::size_t>(column) * channels;
  }
  static void load_averages(Lanes& x, const T* averages) { load(x, averages); }
  static void store_averages(T* averages, const Lanes& x) { store(averages, x); }
};

} // namespace
} // namespace haarlight::wavelet::haar
