#pragma once
// The Haar transform of one tile of an image, two levels at a time. The averages of 4 × 4 blocks go
// to a plane of their own, a quarter as wide and high, and the same is done there, until one row of
// averages is left; then they go back to the blocks' first pixels. So each pixel is read and
// written once but for the first row of each block, which is written twice while in cache.

#include "transform/haar_blocks.h"
#include "transform/transform_tile.h"

namespace haarlight::wavelet::haar {
namespace {

/// Applies Step to a strip of blocks, from pixel x on, as long as a whole Columns fits; returns the
/// pixel after.
template <class Step, class Columns, class T>
int apply_while_fitting(const Blocks<T>& strip, int x, int width) {
  constexpr int step = 4 * Columns::blocks;
  for (; x + step <= width; x += step) {
    Blocks<T> b = strip;
    b.first += static_cast<std::size_t>(x) * b.channels;
    b.averages += static_cast<std::size_t>(x / 4) * b.channels;
    Step::template apply<Columns>(b);
  }
  return x;
}

/// All channels of the strip's first block, from `channel` on, as long as `lanes` of them are left.
template <class Step, int lanes, class T>
std::size_t apply_to_channels(const Blocks<T>& strip, std::size_t channel) {
  for (; channel + lanes <= strip.channels; channel += lanes) {
    Blocks<T> b = strip;
    b.first += channel;
    b.averages += channel;
    Step::template apply<AnyColumns<T, lanes>>(b);
  }
  return channel;
}

template <class Step, class T, int bytes>
void apply_to_any(Blocks<T> strip, int x, int width) {
  constexpr int lanes = bytes / sizeof(T);
  strip.first += static_cast<std::size_t>(x) * strip.channels;
  strip.averages += static_cast<std::size_t>(x / 4) * strip.channels;
  for (; x < width; x += 4) {
    std::size_t channel = apply_to_channels<Step, lanes>(strip, 0);
    channel = apply_to_channels<Step, 16 / sizeof(T)>(strip, channel);
    channel = apply_to_channels<Step, 8 / sizeof(T)>(strip, channel);
    apply_to_channels<Step, 1>(strip, channel);
    strip.first += 4 * strip.channels;
    strip.averages += strip.channels;
  }
}

template <class Step, class T, int bytes>
int apply_to_planar(const Blocks<T>& strip, int x, int width) {
  if constexpr (bytes >= 16) {
    x = apply_while_fitting<Step, PlanarColumns<T, bytes / sizeof(T)>>(strip, x, width);
    x = apply_to_planar<Step, T, bytes / 2>(strip, x, width);
  }
  return x;
}

template <class Step, class T, int bytes>
int apply_to_rgb(const Blocks<T>& strip, int x, int width) {
  if constexpr (bytes >= 4 * sizeof(T)) {
    x = apply_while_fitting<Step, RgbColumns<T, bytes / sizeof(T)>>(strip, x, width);
    x = apply_to_rgb<Step, T, bytes / 2>(strip, x, width);
  }
  return x;
}

/// Applies Step to all blocks of a plane.
/// @tparam bytes of a vector: 16, 32 or 64
template <class Step, class T, int bytes>
void apply(const Plane<T>& plane, const Plane<T>& averages, std::size_t channels) {
  Blocks<T> strip = {plane.data, plane.pitch, averages.data, channels};
  for (int y = 0; y < plane.height; y += 4) {
    int x = 0;
    if (channels == 1)
      x = apply_to_planar<Step, T, bytes>(strip, x, plane.width);
    if (channels == 3)
      x = apply_to_rgb<Step, T, bytes>(strip, x, plane.width);
    apply_to_any<Step, T, bytes>(strip, x, plane.width);
    strip.first += 4 * plane.pitch;
    strip.averages += averages.pitch;
  }
}

template <class T>
Plane<T> averages_of(const Plane<T>& plane, T* data, std::size_t channels) {
  return {data, static_cast<std::size_t>(plane.width / 4) * channels, plane.width / 4,
          plane.height / 4};
}

struct Forward {
  using Down = LiftBlocks;
  using Up = CloseBlocks;
  template <class T>
  static void square(T& a, T& b, T& c, T& d) {
    lift_square<T>(a, b, c, d);
  }
};

struct Inverse {
  using Down = OpenBlocks;
  using Up = UnliftBlocks;
  template <class T>
  static void square(T& a, T& b, T& c, T& d) {
    unlift_square<T>(a, b, c, d);
  }
};

/// The one level of the 2 × 2 averages left of a tile whose height is an odd power of two.
template <class Direction, class T>
void transform_square(const Plane<T>& plane, std::size_t channels) {
  T* a = plane.data;
  for (std::size_t c = 0; c < channels; ++c, ++a)
    Direction::square(a[0], a[channels], a[plane.pitch], a[plane.pitch + channels]);
}

template <class Direction, class T, int bytes>
__attribute__((flatten)) void transform_all_levels(const Tile<T>& tile) {
  Plane<T> planes[4] = {tile.pixels};
  T* free = tile.scratch;
  int k = 0;
  for (; planes[k].height >= 4; ++k) {
    planes[k + 1] = averages_of(planes[k], free, tile.channels);
    free += planes[k + 1].pitch * static_cast<std::size_t>(planes[k + 1].height);
    apply<typename Direction::Down, T, bytes>(planes[k], planes[k + 1], tile.channels);
  }
  if (planes[k].height == 2)
    transform_square<Direction>(planes[k], tile.channels);
  for (; k > 0; --k)
    apply<typename Direction::Up, T, bytes>(planes[k - 1], planes[k], tile.channels);
}

} // namespace

template <int bytes>
void TileTransform<bytes>::forward(const Tile<float>& tile) {
  transform_all_levels<Forward, float, bytes>(tile);
}
template <int bytes>
void TileTransform<bytes>::forward(const Tile<double>& tile) {
  transform_all_levels<Forward, double, bytes>(tile);
}
template <int bytes>
void TileTransform<bytes>::inverse(const Tile<float>& tile) {
  transform_all_levels<Inverse, float, bytes>(tile);
}
template <int bytes>
void TileTransform<bytes>::inverse(const Tile<double>& tile) {
  transform_all_levels<Inverse, double, bytes>(tile);
}

} // namespace haarlight::wavelet::haar
