#include <wavelet/transform/transform.h>

#include <wavelet/base/parallel.h>

#include "transform/transform_lanes.h"
#include "transform/transform_tile.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <memory>
#include <new>

namespace haarlight::wavelet {
namespace haar {
namespace {

/// Uninitialised elements that start a cache line: here if they are few, or allocated.
template <class T>
class Scratch {
public:
  explicit Scratch(std::size_t size)
      : m_more(size <= few ? nullptr
                           : static_cast<T*>(::operator new(size * sizeof(T), alignment))) {}
  T* data() { return m_more ? m_more.get() : m_few; }

private:
  static constexpr std::size_t few = 1280;
  static constexpr std::align_val_t alignment{64};
  struct Free {
    void operator()(T* data) const { ::operator delete(data, alignment); }
  };
  alignas(64) T m_few[few];
  std::unique_ptr<T, Free> m_more;
};

/// An image cut into tiles, and the image of the averages of squares of tile_height pixels a side.
template <class T>
class Image {
public:
  Image(T* data, int size, std::size_t channels)
      : m_data(data), m_size(size), m_channels(channels),
        m_width(std::min(size, widest_tile(channels))), m_height(std::min(size, tile_height)),
        m_averages_size(size > tile_height ? size / tile_height : 0),
        m_scratch(averages_room() + scratch_size(m_width, m_height, channels)) {}

  /// 0 if the image is a single tile.
  int averages_size() const { return m_averages_size; }
  T* averages() { return m_scratch.data(); }

  /// Calls work(tile, x, y) for all tiles and the place of their first pixel.
  template <class Work>
  void for_each_tile(Work work) {
    const std::size_t pitch = static_cast<std::size_t>(m_size) * m_channels;
    for (int y = 0; y < m_size; y += m_height)
      for (int x = 0; x < m_size; x += m_width)
        work(Tile<T>{{pixel(x, y), pitch, m_width, m_height},
                     m_channels,
                     m_scratch.data() + averages_room()},
             x, y);
  }

  /// From the first pixels of the squares of the tile at (x, y).
  void take_averages(int x, int y) {
    for_each_square(
        x, y, [&](T* first, T* average) { std::memcpy(average, first, m_channels * sizeof(T)); });
  }
  void give_averages(int x, int y) {
    for_each_square(
        x, y, [&](T* first, T* average) { std::memcpy(first, average, m_channels * sizeof(T)); });
  }

private:
  /// So wide that coarse levels fill vectors, and a tile stays in a second-level cache.
  static int widest_tile(std::size_t channels) {
    return (channels == 1 ? 4 : channels <= 4 ? 2 : 1) * tile_height;
  }

  /// Whole cache lines.
  std::size_t averages_room() const {
    const auto size = static_cast<std::size_t>(m_averages_size);
    return (size * size * m_channels + 15) / 16 * 16;
  }

  T* pixel(int x, int y) const {
    return m_data + (static_cast<std::size_t>(y) * static_cast<std::size_t>(m_size) +
                     static_cast<std::size_t>(x)) *
                        m_channels;
  }

  template <class Work>
  void for_each_square(int x, int y, Work work) {
    for (int end = x + m_width; m_averages_size > 0 && x < end; x += tile_height)
      work(pixel(x, y), averages() + static_cast<std::size_t>(y / tile_height * m_averages_size +
                                                              x / tile_height) *
                                         m_channels);
  }

  T* m_data;
  int m_size;
  std::size_t m_channels;
  int m_width;
  int m_height;
  int m_averages_size;
  Scratch<T> m_scratch;
};

template <class T>
void forward_tile(const Tile<T>& tile, Width width) {
  switch (width) {
  case Width::Sse:
    return TileTransform<16>::forward(tile);
  case Width::Avx:
    return TileTransform<32>::forward(tile);
  case Width::Avx512:
    return TileTransform<64>::forward(tile);
  }
}

template <class T>
void inverse_tile(const Tile<T>& tile, Width width) {
  switch (width) {
  case Width::Sse:
    return TileTransform<16>::inverse(tile);
  case Width::Avx:
    return TileTransform<32>::inverse(tile);
  case Width::Avx512:
    return TileTransform<64>::inverse(tile);
  }
}

/// Calls work(image) for images one after another, a few of them to a thread at least.
template <class T, class Work>
void for_each_image(T* images, std::size_t count, int size, int channels, Work work) {
  constexpr std::size_t worth_a_thread = 1 << 16;
  const std::size_t elements = static_cast<std::size_t>(size) * static_cast<std::size_t>(size) *
                               static_cast<std::size_t>(channels);
  parallel_ranges(count, worth_a_thread / elements + 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      work(images + i * elements);
  });
}

} // namespace

Width widest() {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  static const Width width = __builtin_cpu_supports("x86-64-v4")   ? Width::Avx512
                             : __builtin_cpu_supports("x86-64-v3") ? Width::Avx
                                                                   : Width::Sse;
  return width;
#else
  return Width::Sse;
#endif
}

template <class T>
void forward(T* data, int size, int channels, Width width) {
  assert(size > 0 && std::has_single_bit(static_cast<unsigned>(size)) && channels > 0);
  Image<T> image(data, size, static_cast<std::size_t>(channels));
  image.for_each_tile([&](const Tile<T>& tile, int x, int y) {
    forward_tile(tile, width);
    image.take_averages(x, y);
  });
  if (image.averages_size() == 0)
    return;
  forward(image.averages(), image.averages_size(), channels, width);
  image.for_each_tile([&](const Tile<T>&, int x, int y) { image.give_averages(x, y); });
}

template <class T>
void inverse(T* data, int size, int channels, Width width) {
  assert(size > 0 && std::has_single_bit(static_cast<unsigned>(size)) && channels > 0);
  Image<T> image(data, size, static_cast<std::size_t>(channels));
  if (image.averages_size() > 0) {
    image.for_each_tile([&](const Tile<T>&, int x, int y) { image.take_averages(x, y); });
    inverse(image.averages(), image.averages_size(), channels, width);
  }
  image.for_each_tile([&](const Tile<T>& tile, int x, int y) {
    image.give_averages(x, y);
    inverse_tile(tile, width);
  });
}

template void forward(float*, int, int, Width);
template void forward(double*, int, int, Width);
template void inverse(float*, int, int, Width);
template void inverse(double*, int, int, Width);

} // namespace haar

void haar_forward(float* image, int size, int channels) {
  haar::forward(image, size, channels, haar::widest());
}
void haar_forward(double* image, int size, int channels) {
  haar::forward(image, size, channels, haar::widest());
}
void haar_inverse(float* image, int size, int channels) {
  haar::inverse(image, size, channels, haar::widest());
}
void haar_inverse(double* image, int size, int channels) {
  haar::inverse(image, size, channels, haar::widest());
}

void haar_forward_batch(float* images, std::size_t count, int size, int channels) {
  haar::for_each_image(images, count, size, channels,
                       [&](float* image) { haar_forward(image, size, channels); });
}
void haar_forward_batch(double* images, std::size_t count, int size, int channels) {
  haar::for_each_image(images, count, size, channels,
                       [&](double* image) { haar_forward(image, size, channels); });
}
void haar_inverse_batch(float* images, std::size_t count, int size, int channels) {
  haar::for_each_image(images, count, size, channels,
                       [&](float* image) { haar_inverse(image, size, channels); });
}
void haar_inverse_batch(double* images, std::size_t count, int size, int channels) {
  haar::for_each_image(images, count, size, channels,
                       [&](double* image) { haar_inverse(image, size, channels); });
}

} // namespace haarlight::wavelet
