#pragma once
// Squares of the domain, by level and place.

#include <cstdint>

namespace haarlight::wavelet {

/// The square of side 2^-level whose lower corner is (column, row) · 2^-level.
struct SquarePlace {
  std::int32_t level = 0;
  std::uint32_t column = 0;
  std::uint32_t row = 0;

  /// Quadrant q = qx + 2 qy.
  SquarePlace quadrant(unsigned q) const {
    return {level + 1, 2 * column + (q & 1U), 2 * row + (q >> 1U)};
  }
};

} // namespace haarlight::wavelet
