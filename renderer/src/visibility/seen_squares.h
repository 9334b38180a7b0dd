#pragma once
// How much of a square the objects of a scene leave visible from a point, by estimate: quick enough
// to be asked of every square that a sampler has to do with.

#include "visibility/cap_region.h"
#include "visibility/outline.h"

#include <renderer/visibility/visibility.h>

#include <wavelet/product/adaptive_product.h>

#include <vector>

namespace haarlight::renderer::detail {

/// What may be in the way, as seen from some point; directions are the light's.
struct Obstacle {
  Cap bounds;                   ///< all that it hides lies within
  Outline outline;              ///< of the box around the solid
  const Solid* solid = nullptr; ///< that rays tell the outline of; else all in the bounds is hidden
  Vec3 origin;                  ///< the point in the solid's frame
  Eigen::Matrix3f to_object;    ///< of directions
};

/// Turned to one point after another. Squares that lie all within a sphere's outline or behind a
/// plane or one convex shape, or beside all objects, are known; others are looked at in eight
/// points, for all objects together.
class SeenSquares final : public wavelet::SquareVisibility {
public:
  /// @param shapes, light must outlive this
  SeenSquares(const ShapeSet& shapes, const Light& light);

  /// @param from its normal points to the side that is seen
  void set_shading_point(const Hit& from);

  void query_visibility(std::span<const wavelet::Square> squares,
                        std::span<wavelet::SquareView> views) override;

private:
  void add(const Solid& solid, const Eigen::Vector3d& origin);
  wavelet::SquareView view_of(const wavelet::Square& square, std::uint64_t occluders) const;

  const ShapeSet& m_shapes;
  const Light& m_light;
  VisibilityTrees m_visibility;
  Vec3 m_normal;                     ///< in the light's frame
  std::vector<Obstacle> m_obstacles; ///< number i is bit min(i, 63) of SquareView::occluders
};

} // namespace haarlight::renderer::detail
