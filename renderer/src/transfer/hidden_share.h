#pragma once
// How much of a transfer lies behind a ball.

#include "../visibility/cap_region.h"

#include <wavelet/tree.h>

#include <vector>

namespace haarlight::renderer::detail {

/// Integrates trees over caps: a square wholly inside counts with its average, one wholly outside
/// not at all, so that only what the cap's edge crosses is looked into. Shared by threads.
class HiddenShare {
public:
  /// @param levels of the trees
  explicit HiddenShare(int levels);

  /// ∫∫ T over the cap, per channel; the whole square's area is 1.
  Rgb within(const wavelet::TreeView& tree, const Cap& cap) const;

private:
  struct Square {
    std::uint32_t index; ///< in a complete tree: quadrant q of i is 4 i + 1 + q
    wavelet::SquarePlace place;
  };

  wavelet::RegionPart classify(const Square& square, const Cap& cap) const;
  Float4 within(const wavelet::TreeView& tree, std::uint32_t node, Float4 mean,
                const Square& square, const Cap& cap) const;

  std::vector<wavelet::SquareCap> m_bounds; ///< of the coarser squares, as in a complete tree
};

} // namespace haarlight::renderer::detail
