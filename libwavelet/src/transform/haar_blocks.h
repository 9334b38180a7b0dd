#pragma once
// Two levels of the Haar transform on 4 × 4 blocks of pixels held in registers, in two steps: the
// averages of blocks go away in the one and come back in the other. Between them a block's first
// row lies unordered ("parked") in its own place.

#include "transform/haar_columns.h"

namespace haarlight::wavelet::haar {
namespace {

/// One lifting step on a pair: average into `a`, half difference into `b`.
template <class T, class Lanes>
void lift(Lanes& a, Lanes& b) {
  const Lanes difference = T(0.5) * (a - b);
  a -= difference;
  b = difference;
}

template <class T, class Lanes>
void unlift(Lanes& a, Lanes& b) {
  const Lanes sum = a + b;
  b = a - b;
  a = sum;
}

/// A level of 2 × 2 pixels: a b over c d.
template <class T, class Lanes>
void lift_square(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  lift<T>(a, b);
  lift<T>(c, d);
  lift<T>(a, c);
  lift<T>(b, d);
}

template <class T, class Lanes>
void unlift_square(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  unlift<T>(a, c);
  unlift<T>(b, d);
  unlift<T>(a, b);
  unlift<T>(c, d);
}

/// Where blocks lie side by side, and where their averages.
template <class T>
struct Blocks {
  T* first; ///< of the first row
  std::size_t pitch;
  T* averages;
  std::size_t channels;

  T* row(std::size_t y) const { return first + y * pitch; }
};

template <class Columns, class T>
void park(const Blocks<T>& b, const typename Columns::Lanes (&x)[4]) {
  store(b.first + Columns::parking(1, b.channels), x[1]);
  store(b.first + Columns::parking(2, b.channels), x[2]);
  store(b.first + Columns::parking(3, b.channels), x[3]);
}

template <class Columns, class T>
void unpark(typename Columns::Lanes (&x)[4], const Blocks<T>& b) {
  load(x[1], b.first + Columns::parking(1, b.channels));
  load(x[2], b.first + Columns::parking(2, b.channels));
  load(x[3], b.first + Columns::parking(3, b.channels));
}

/// Lifts blocks but for their first row's order; their averages go down.
struct LiftBlocks {
  template <class Columns, class T>
  static void apply(const Blocks<T>& b) {
    typename Columns::Lanes x[4];
    typename Columns::Lanes y[4];
    typename Columns::Lanes z[4];
    lift_rows<Columns>(x, y, b, 0);
    lift_rows<Columns>(z, y, b, 2);
    Columns::split(x[0], x[2]);
    Columns::split(z[0], z[2]);
    lift_square<T>(x[0], x[2], z[0], z[2]);
    Columns::join(z[0], z[2]);
    Columns::store_row(b.row(2), z, b.channels);
    park<Columns>(b, x);
    Columns::store_averages(b.averages, x[0]);
  }

private:
  /// The finer level of two rows, of which the second is done then.
  template <class Columns, class T>
  static void lift_rows(typename Columns::Lanes (&x)[4], typename Columns::Lanes (&y)[4],
                        const Blocks<T>& b, std::size_t row) {
    Columns::load_row(x, b.row(row), b.channels);
    Columns::load_row(y, b.row(row + 1), b.channels);
    lift_square<T>(x[0], x[1], y[0], y[1]);
    lift_square<T>(x[2], x[3], y[2], y[3]);
    Columns::store_row(b.row(row + 1), y, b.channels);
  }
};

/// Takes the averages back and orders the first row.
struct CloseBlocks {
  template <class Columns, class T>
  static void apply(const Blocks<T>& b) {
    typename Columns::Lanes x[4];
    Columns::load_averages(x[0], b.averages);
    unpark<Columns>(x, b);
    Columns::join(x[0], x[2]);
    Columns::store_row(b.first, x, b.channels);
  }
};

/// The inverse of CloseBlocks.
struct OpenBlocks {
  template <class Columns, class T>
  static void apply(const Blocks<T>& b) {
    typename Columns::Lanes x[4];
    Columns::load_row(x, b.first, b.channels);
    Columns::split(x[0], x[2]);
    park<Columns>(b, x);
    Columns::store_averages(b.averages, x[0]);
  }
};

/// The inverse of LiftBlocks.
struct UnliftBlocks {
  template <class Columns, class T>
  static void apply(const Blocks<T>& b) {
    typename Columns::Lanes x[4];
    typename Columns::Lanes z[4];
    Columns::load_averages(x[0], b.averages);
    unpark<Columns>(x, b);
    Columns::load_row(z, b.row(2), b.channels);
    Columns::split(z[0], z[2]);
    unlift_square<T>(x[0], x[2], z[0], z[2]);
    Columns::join(x[0], x[2]);
    Columns::join(z[0], z[2]);
    unlift_rows<Columns>(x, b, 0);
    unlift_rows<Columns>(z, b, 2);
  }

private:
  template <class Columns, class T>
  static void unlift_rows(typename Columns::Lanes (&x)[4], const Blocks<T>& b, std::size_t row) {
    typename Columns::Lanes y[4];
    Columns::load_row(y, b.row(row + 1), b.channels);
    unlift_square<T>(x[0], x[1], y[0], y[1]);
    unlift_square<T>(x[2], x[3], y[2], y[3]);
    Columns::store_row(b.row(row), x, b.channels);
    Columns::store_row(b.row(row + 1), y, b.channels);
  }
};

} // namespace
} // namespace haarlight::wavelet::haar
