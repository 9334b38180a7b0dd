#pragma once
// How much of a square the objects of a scene leave visible from a point, by estimate: quick enough
// to be asked of every square that a sampler has to do with.

#include "cap_region.h"

#include <renderer/visibility.h>

#include <wavelet/occlusion.h>

#include <cmath>
#include <optional>
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

/// A shape that rays tell the outline of, as seen from some point; directions are the light's.
struct RaySolid {
  const Solid* solid = nullptr;
  Cap bounds; ///< around its bounding sphere
  Belt belt;  ///< that holds all directions to it
  Eigen::Vector3d origin;
  Eigen::Matrix3d to_object;

  bool meet(const Vec3& w) const;
};

/// Turned to one point after another. Squares that lie all within a sphere's outline or behind a
/// plane or one convex shape, or beside all objects, are known; others are looked at in 3 × 3
/// points, for all objects together.
class SeenSquares final : public wavelet::Occlusion {
public:
  /// @param shapes, light must outlive this
  SeenSquares(const ShapeSet& shapes, const Light& light);

  /// @param from must live until the next call; its normal points to the side that is seen
  void turn_to(const Hit& from) {
    m_from = &from;
    m_turned = false;
  }

  void find(std::span<const wavelet::SquarePlace> squares, std::span<float> seen) override;

private:
  void turn();
  void add(const Solid& solid, const Eigen::Vector3d& origin);
  float seen_of(const wavelet::SquarePlace& square) const;

  const ShapeSet& m_shapes;
  const Light& m_light;
  VisibilityTrees m_visibility;
  const Hit* m_from = nullptr;
  bool m_turned = false;
  Vec3 m_normal;           ///< the light's
  std::vector<Cap> m_caps; ///< all that is within is hidden
  std::vector<RaySolid> m_solids;
};

} // namespace haarlight::renderer::detail
