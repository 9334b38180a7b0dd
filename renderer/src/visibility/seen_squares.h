#pragma once
// How much of a square the objects of a scene leave visible from a point, by estimate: quick enough
// to be asked of every square that a sampler has to do with.

#include "cap_region.h"

#include <renderer/visibility.h>

#include <wavelet/square_visibility.h>

#include <cmath>
#include <vector>

namespace haarlight::renderer::detail {

/// The directions at nearly right angles to a normal.
struct Belt {
  Vec3 normal = Vec3::UnitZ(); ///< unit
  float sine = 1;              ///< of the angle that they may be off by

  bool is_beside(const wavelet::SquareCap& cap) const {
    constexpr float chord_to_sine = 1.1F; // at most, of squares of level 3 and finer
    return std::abs(normal.dot(cap.centre)) > sine + chord_to_sine * cap.sine;
  }
};

/// What may be in the way, as seen from some point; directions are the light's.
struct Obstacle {
  Cap bounds; ///< all that it hides lies within
  const Solid* solid =
      nullptr; ///< that rays tell the outline of; else all within `bounds` is hidden
  Belt belt;   ///< that holds all directions to the solid
  Eigen::Vector3d origin;
  Eigen::Matrix3d to_object;

  bool meet(const Vec3& w) const;
};

/// Turned to one point after another. Squares that lie all within a sphere's outline or behind a
/// plane or one convex shape, or beside all objects, are known; others are looked at in 3 × 3
/// points, for all objects together.
class SeenSquares final : public wavelet::SquareVisibility {
public:
  /// @param shapes, light must outlive this
  SeenSquares(const ShapeSet& shapes, const Light& light);

  /// @param from its normal points to the side that is seen
  void turn_to(const Hit& from);

  void look(std::span<const wavelet::SquarePlace> squares,
            std::span<wavelet::SquareView> views) override;

private:
  void add(const Solid& solid, const Eigen::Vector3d& origin);
  wavelet::SquareView view_of(const wavelet::SquarePlace& square, std::uint64_t occluders) const;

  const ShapeSet& m_shapes;
  const Light& m_light;
  VisibilityTrees m_visibility;
  Vec3 m_normal;                     ///< in the light's frame
  std::vector<Obstacle> m_obstacles; ///< number i is bit min(i, 63) of SquareView::occluders
};

} // namespace haarlight::renderer::detail
