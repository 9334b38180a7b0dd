#include <wavelet/transform.h>

#include <bit>
#include <cassert>

namespace haarlight::wavelet {
namespace {

/// One lifting step on a pair: average into `a`, half difference into `b`.
template <class T>
void lift(T& a, T& b) {
  const T difference = T(0.5) * (a - b);
  a -= difference;
  b = difference;
}

template <class T>
void unlift(T& a, T& b) {
  const T sum = a + b;
  b = a - b;
  a = sum;
}

/// The four corners of a 2 × 2 block, `reach` elements apart along a row and `drop` along a column.
template <class T>
void forward_block(T* a, std::size_t reach, std::size_t drop) {
  lift(a[0], a[reach]);
  lift(a[drop], a[drop + reach]);
  lift(a[0], a[drop]);
  lift(a[reach], a[drop + reach]);
}

template <class T>
void inverse_block(T* a, std::size_t reach, std::size_t drop) {
  unlift(a[0], a[drop]);
  unlift(a[reach], a[drop + reach]);
  unlift(a[0], a[reach]);
  unlift(a[drop], a[drop + reach]);
}

/// Calls `block` for every 2 × 2 block of the level whose samples lie `stride` pixels apart.
template <class T, class Block>
void for_each_block(T* image, int size, int channels, int stride, Block block) {
  const auto reach = static_cast<std::size_t>(stride) * static_cast<std::size_t>(channels);
  const std::size_t drop = reach * static_cast<std::size_t>(size);
  for (int y = 0; y < size; y += 2 * stride) {
    T* row = image + static_cast<std::size_t>(y) * static_cast<std::size_t>(size) *
                         static_cast<std::size_t>(channels);
    for (int x = 0; x < size; x += 2 * stride, row += 2 * reach)
      for (int c = 0; c < channels; ++c)
        block(row + c, reach, drop);
  }
}

template <class T>
void forward(T* image, int size, int channels) {
  assert(std::has_single_bit(static_cast<unsigned>(size)));
  for (int stride = 1; stride < size; stride *= 2)
    for_each_block(image, size, channels, stride, forward_block<T>);
}

template <class T>
void inverse(T* image, int size, int channels) {
  assert(std::has_single_bit(static_cast<unsigned>(size)));
  for (int stride = size / 2; stride >= 1; stride /= 2)
    for_each_block(image, size, channels, stride, inverse_block<T>);
}

} // namespace

void haar_forward(float* image, int size, int channels) { forward(image, size, channels); }
void haar_forward(double* image, int size, int channels) { forward(image, size, channels); }
void haar_inverse(float* image, int size, int channels) { inverse(image, size, channels); }
void haar_inverse(double* image, int size, int channels) { inverse(image, size, channels); }

} // namespace haarlight::wavelet
