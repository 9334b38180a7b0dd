#pragma once
// The tiles that an image is transformed in, with vectors of a chosen width. haar_tile.h holds the
// code; transform_sse.cpp, transform_avx.cpp and transform_avx512.cpp compile it, each for its
// instruction set. What they include has internal linkage, lest the linker take the one's code for
// the other's. All widths give the same bits.

#include <cstddef>

namespace haarlight::wavelet::haar {

constexpr int tile_height = 64;

template <class T>
struct Plane {
  T* data;
  std::size_t pitch; ///< elements from row to row
  int width;         ///< in pixels
  int height;        ///< 1 … tile_height, a power of two; at most the width
};

/// A tile and the room for its coarser levels.
template <class T>
struct Tile {
  Plane<T> pixels;
  std::size_t channels;
  T* scratch; ///< as many elements as scratch_size() says
};

/// Elements of the planes of averages, and one vector more: wide stores may write past their end.
constexpr std::size_t scratch_size(int width, int height, std::size_t channels) {
  std::size_t size = 16;
  for (; height >= 4; height /= 4, width /= 4)
    size += static_cast<std::size_t>(width / 4) * static_cast<std::size_t>(height / 4) * channels;
  return size;
}

/// All levels of a square tile, or of the squares of tile_height pixels a side of a wider one.
/// @tparam bytes of a vector: 16, 32 or 64
template <int bytes>
struct TileTransform {
  static void forward(const Tile<float>& tile);
  static void forward(const Tile<double>& tile);
  static void inverse(const Tile<float>& tile);
  static void inverse(const Tile<double>& tile);
};

} // namespace haarlight::wavelet::haar
