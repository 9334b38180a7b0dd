#pragma once
// Squares of the dyadic grid as keys of hash tables, and signs of the wavelets over quadrants.

#include <cassert>
#include <cstddef>
#include <cstdint>

namespace haarlight::wavelet::reference {

/// The square s = (l, x, y) of side 2^-l: [x, x + 1]·2^-l × [y, y + 1]·2^-l; x runs with columns,
/// y with rows.
struct Square {
  int level = 0; ///< 0 … 28
  int x = 0;     ///< 0 … 2^level − 1
  int y = 0;     ///< 0 … 2^level − 1

  bool operator==(const Square&) const = default;
};

struct SquareHash {
  std::size_t operator()(const Square& s) const {
    const auto key = (static_cast<std::uint64_t>(s.level) << 58U) ^
                     (static_cast<std::uint64_t>(s.x) << 29U) ^ static_cast<std::uint64_t>(s.y);
    const std::uint64_t mixed = key * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(mixed ^ (mixed >> 32U));
  }
};

/// The square at a level no finer than its own that holds `s`, which may be `s` itself.
inline Square ancestor(const Square& s, int level) {
  assert(0 <= level && level <= s.level);
  return {level, s.x >> (s.level - level), s.y >> (s.level - level)};
}

/// @param s not the root
inline Square parent(const Square& s) { return ancestor(s, s.level - 1); }

/// Quadrant (qx, qy) ∈ {0, 1}² of a square.
inline Square child(const Square& s, int qx, int qy) {
  return {s.level + 1, 2 * s.x + qx, 2 * s.y + qy};
}

/// Whether `inner` lies within `outer` or is the same.
inline bool contains(const Square& outer, const Square& inner) {
  return outer.level <= inner.level && ancestor(inner, outer.level) == outer;
}

/// sign(m, qx, qy) of section 4.5: of ψ^m over the quadrant (qx, qy) of its square. m = 1 is the
/// x-difference (+, −), m = 2 the y-difference, m = 3 the diagonal one, the product of the two;
/// m = 0, the scaling function, is positive.
inline int sign(int m, int qx, int qy) {
  assert(0 <= m && m <= 3);
  const int negative = (m & qx) ^ ((m >> 1) & qy);
  return 1 - 2 * negative;
}

/// Sign over all of `inner` of the function of type m on `outer`. @param inner strictly finer than
/// `outer`, and within it
inline int sign_over(int m, const Square& outer, const Square& inner) {
  assert(outer.level < inner.level && contains(outer, inner));
  const Square quadrant = ancestor(inner, outer.level + 1);
  return sign(m, quadrant.x & 1, quadrant.y & 1);
}

} // namespace haarlight::wavelet::reference
