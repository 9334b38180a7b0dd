#pragma once
// What a finite shape of any kind leaves visible.

#include "visibility/cap_region.h"

#include <renderer/light/light.h>
#include <renderer/shapes/shapes.h>

#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

#include <cstddef>
#include <vector>

namespace haarlight::renderer::detail {

/// Points of a square that rays sample it by: a (0, 2)-net of 16 (Sobol'), as are its first 4.
inline constexpr std::size_t net_size = 16;
Vec2 net_point(const wavelet::Square& square, std::size_t index);

/// Rays from one point against one shape; directions are the light's.
class SolidRays {
public:
  /// @param light must outlive this, and so must the solid
  SolidRays(const Solid& solid, const Eigen::Vector3d& origin, const Light& light);

  bool meet(const Vec3& direction) const;

  /// Whether no ray into the cap meets the shape; may say no where it would be hard to tell.
  bool all_miss(const wavelet::SquareCap& cap) const;
  /// Whether all of them do; likewise.
  bool all_meet(const wavelet::SquareCap& cap) const;

private:
  /// How far the whole shape lies beyond a plane through the origin of the rays, on the side that
  /// its unit normal points to; negative if not all of it does.
  double clearance(const Vec3& normal) const;
  void find_tube(const Eigen::Vector3d& origin);
  Eigen::Vector3d object_direction(const Vec3& direction) const;

  const Light& m_light;
  const Solid& m_solid;
  Cap m_bounds;                    ///< around the shape's bounding sphere
  std::vector<Cap> m_tube;         ///< of a torus: around balls that hold all of its tube …
  std::vector<Cap> m_core;         ///< … and around such as lie within it
  Eigen::Vector3d m_to_shape;      ///< from the origin to the shape's own origin
  Eigen::Vector3d m_object_origin; ///< the rays', as the shape sees it
};

/// 1 where rays miss a shape.
class SolidRegion final : public wavelet::Region {
public:
  SolidRegion(const Solid& solid, const Eigen::Vector3d& origin, const Light& light)
      : m_rays(solid, origin, light) {}

  wavelet::RegionPart classify(const wavelet::Square& square) const override;
  float coverage(const wavelet::Square& square) const override;

private:
  SolidRays m_rays;
};

} // namespace haarlight::renderer::detail
