#pragma once
// Two-dimensional point sets for a pixel's samples.

#include <wavelet/geometry.h>

#include <cstdint>
#include <span>

namespace haarlight::renderer {

enum class Points {
  Random, ///< independent, uniform
  Sobol   ///< the first two dimensions of Sobol's sequence, Owen-scrambled (Burley 2020), own for
          ///< each pixel and dimension; any run of 2^k aligned indices is a (0, k, 2)-net
};

/// Mixes two 32-bit words into one; every bit of the result depends on all of them.
std::uint32_t hash_words(std::uint32_t a, std::uint32_t b);

/// Fills `out` with points `first`, `first + 1`, … of a set in [0, 1)².
/// @param key tells sets apart: pixels, seeds, dimensions
void fill_points(Points kind, std::uint32_t key, std::uint32_t first, std::span<Vec2> out);

/// The same in an order of its own for each key, in which aligned runs of 2^k stay nets: sets of
/// different keys then go together point by point, as the dimensions of one path do.
void fill_shuffled_points(Points kind, std::uint32_t key, std::uint32_t first, std::span<Vec2> out);

} // namespace haarlight::renderer
