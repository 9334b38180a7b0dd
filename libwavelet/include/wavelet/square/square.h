#pragma once
// Squares of the dyadic grid on the unit square.

#include <wavelet/base/geometry.h>
#include <wavelet/base/lanes.h>

#include <cstdint>

namespace haarlight::wavelet {

/// The square of side 2^-level whose lower corner is (column, row) · 2^-level. Columns run with u,
/// rows with v; quadrants are numbered q = qx + 2 qy.
struct Square {
  std::int32_t level = 0; ///< 0 … 28
  std::uint32_t column = 0;
  std::uint32_t row = 0;

  bool operator==(const Square&) const = default;

  float side() const { return power_of_two(-level); }
  float area() const { return power_of_two(-2 * level); }

  /// The point (s, t) ∈ [0, 1]² of the square in unit-square coordinates (u, v).
  Vec2 point(float s, float t) const {
    return {(static_cast<float>(column) + s) * side(), (static_cast<float>(row) + t) * side()};
  }
  Vec2 centre() const { return point(0.5F, 0.5F); }

  Square quadrant(unsigned q) const {
    return {level + 1, 2 * column + (q & 1U), 2 * row + (q >> 1U)};
  }
  /// Which quadrant of its parent the square is. Not of the root.
  unsigned index_in_parent() const { return (column & 1U) + 2 * (row & 1U); }

  /// The square at a level ≤ its own that holds it.
  Square ancestor(std::int32_t coarser) const {
    const auto shift = static_cast<unsigned>(level - coarser);
    return {coarser, column >> shift, row >> shift};
  }
  Square parent() const { return ancestor(level - 1); }

  /// Whether `inner` lies within the square or equals it.
  bool contains(const Square& inner) const {
    return level <= inner.level && inner.ancestor(level) == *this;
  }
};

} // namespace haarlight::wavelet
