#pragma once
// The Haar transform with vectors of a chosen width. All widths give the same bits.

#include <cstddef>

namespace haarlight::wavelet::haar {

enum class Width { Sse, Avx, Avx512 };

/// The widest that this processor has.
Width widest();

/// As haar_forward() and haar_inverse(). T: float or double.
template <class T>
void forward(T* image, int size, int channels, Width width);
template <class T>
void inverse(T* image, int size, int channels, Width width);

} // namespace haarlight::wavelet::haar
