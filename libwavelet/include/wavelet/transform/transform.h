#pragma once
// The orthonormal, non-standard two-dimensional Haar transform of a square image, in place by
// lifting.
//
// After haar_forward() the image holds, instead of pixels, the differences of averages: for the
// square s = (l, x, y) of side 2^-l, with k = N / 2^(l+1),
//     m = 1 (x-difference)        at pixel (2kx + k, 2ky)
//     m = 2 (y-difference)        at pixel (2kx,     2ky + k)
//     m = 3 (diagonal difference) at pixel (2kx + k, 2ky + k)
// and the average of the whole image at (0, 0). A stored value d relates to the coefficient of the
// L2-normalised wavelet on the unit square by F^m_s = 2^-l d: it is in the unit of the pixels, and
// the average of child quadrant (qx, qy) is F(s) + Σ_m sign(m, qx, qy) d_m with sign(1) = 1 − 2qx,
// sign(2) = 1 − 2qy, sign(3) = sign(1)·sign(2).

#include <wavelet/square/square.h>

#include <cstddef>

namespace haarlight::wavelet {

/// Transforms `channels` interleaved channels of a size × size image, row 0 first, in place, on the
/// calling thread. The bits are those of lifting one 2 × 2 block after another, rows before
/// columns, on every processor.
/// @param image    size² · channels elements; need not be aligned beyond its type
/// @param size     a power of two
/// @param channels at least 1
void haar_forward(float* image, int size, int channels);
void haar_forward(double* image, int size, int channels);

/// Exact inverse up to rounding.
void haar_inverse(float* image, int size, int channels);
void haar_inverse(double* image, int size, int channels);

/// Index, in pixels, of coefficient m ∈ {1, 2, 3} of the square (level, x, y) after haar_forward().
inline std::size_t coefficient_index(int size, int level, int x, int y, int m) {
  const int k = size >> (level + 1);
  const int column = 2 * k * x + ((m & 1) != 0 ? k : 0);
  const int row = 2 * k * y + ((m & 2) != 0 ? k : 0);
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
         static_cast<std::size_t>(column);
}
inline std::size_t coefficient_index(int size, const Square& s, int m) {
  return coefficient_index(size, s.level, static_cast<int>(s.column), static_cast<int>(s.row), m);
}

} // namespace haarlight::wavelet
