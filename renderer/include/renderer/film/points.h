#pragma once
// Two-dimensional point sets for a pixel's samples.

#include <wavelet/base/geometry.h>

#include <cstdint>
#include <span>

namespace haarlight::renderer {

enum class Points {
  Random, ///< independent, uniform
  Sobol   ///< the first two dimensions of Sobol's sequence, scrambled and shuffled by Owen's nested
          ///< permutations (Burley 2020); any run of 2^k aligned indices is a (0, k, 2)-net
};

/// Mixes two 32-bit words into one; every bit of the result depends on all of them.
std::uint32_t hash_words(std::uint32_t a, std::uint32_t b);

/// Fills `out` with points `first`, `first + 1`, … of a set in [0, 1)². Each key has its own
/// scrambling and order, so that points of the same index in sets of different keys are
/// independent: pairs of dimensions of one sample are taken from different sets.
/// @param key identifies the set: hash of pixel, seed and dimension
void fill_points(Points kind, std::uint32_t key, std::uint32_t first, std::span<Vec2> out);

} // namespace haarlight::renderer
