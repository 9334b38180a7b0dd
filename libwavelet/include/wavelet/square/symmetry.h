#pragma once
// The symmetry of the square (D4), by which the stored rows of a folded set represent all rolls.

#include <wavelet/tree/map_set.h>

#include <cassert>

namespace haarlight::wavelet {

/// Where a point of a turned map lies in the stored one: first `turns` quarter turns back about the
/// centre, then, if `mirrored`, a mirroring in the diagonal u = v. A quarter turn of a map turns
/// the local frame's content by +90° about z.
struct SquareSymmetry {
  int turns = 0; ///< 0 … 3
  bool mirrored = false;

  Vec2 to_stored(Vec2 p) const {
    for (int i = 0; i < turns; ++i)
      p = Vec2(p.y(), 1.0F - p.x());
    return mirrored ? Vec2(p.y(), p.x()) : p;
  }

  /// The same for quadrants q = qx + 2 qy.
  unsigned to_stored(unsigned q) const {
    unsigned x = q & 1U;
    unsigned y = q >> 1U;
    for (int i = 0; i < turns; ++i) {
      const unsigned turned = 1U - x;
      x = y;
      y = turned;
    }
    return mirrored ? y + 2 * x : x + 2 * y;
  }
};

/// The stored row that represents a roll, and the symmetry to apply.
struct StoredRoll {
  int row = 0;
  SquareSymmetry symmetry;
};

/// @param roll 0 ≤ roll < info.rolls; roll r covers φ ∈ [r, r + 1)·2π/rolls
inline StoredRoll stored_roll(const SetInfo& info, int roll) {
  assert(roll >= 0 && roll < info.rolls);
  if (info.fold == Fold::None)
    return {roll, {}};
  const int quarter = info.rolls / 4;
  StoredRoll result = {roll % quarter, {roll / quarter, false}};
  if (info.fold == Fold::Mirrors && result.row >= info.rows) {
    result.row = quarter - 1 - result.row;
    result.symmetry.mirrored = true;
  }
  return result;
}

} // namespace haarlight::wavelet
