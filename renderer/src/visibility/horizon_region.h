#pragma once
// What the shaded object itself leaves visible.

#include "visibility/cap_region.h"
#include "visibility/solid_region.h"

#include <optional>

namespace haarlight::renderer::detail {

/// 0 below the horizon of a hit and where the shape it lies on is in its own way; elsewhere 1, or
/// n·ω.
class HorizonRegion final : public wavelet::Region {
public:
  /// @param normal in the light's frame
  /// @param own    the shape, if it is not convex
  /// @param cosine whether to weigh by n·ω
  HorizonRegion(const Vec3& normal, const std::optional<SolidRays>& own, bool cosine)
      : m_horizon(Cap::half_space(normal)), m_flat(m_horizon, false), m_own(own), m_cosine(cosine) {
  }

  wavelet::RegionPart classify(const wavelet::Square& square) const override;
  float coverage(const wavelet::Square& square) const override;

private:
  float average_cosine(const wavelet::Square& square, int refinements) const;
  float unshadowed_share(const wavelet::Square& square) const;

  Cap m_horizon;
  CapRegion m_flat;
  std::optional<SolidRays> m_own;
  bool m_cosine;
};

} // namespace haarlight::renderer::detail
