#pragma once
// How much of a transfer lies behind a ball.

#include "visibility/cap_region.h"

#include <wavelet/tree/tree.h>

#include <vector>

namespace haarlight::renderer::detail {

/// Integrates trees over caps: a square wholly inside counts with its average, one wholly outside
/// not at all, so that only what the cap's edge crosses is looked into. Shared by threads.
class HiddenShare {
public:
  HiddenShare();

  /// ∫∫ T over the cap, per channel; the whole square's area is 1.
  Rgb within(const wavelet::TreeView& tree, const Cap& cap) const;

private:
  struct Walk {
    const wavelet::TreeView& tree;
    const Cap& cap;
    float negligible; ///< luminance times area
  };
  struct Place {
    std::uint32_t index; ///< in a complete tree: quadrant q of i is 4 i + 1 + q
    int level;
  };

  Float4 within(const Walk& walk, std::uint32_t node, Float4 mean, const Place& square) const;

  std::vector<wavelet::SquareCap> m_bounds; ///< as in a complete tree
};

} // namespace haarlight::renderer::detail
