#pragma once
// Visibility from a point as trees: the functions v_j of the paper's eqs. 10-13, one per object, in
// the light's frame, so that light, reflectance and visibilities multiply square by square.
//
// For spheres, planes and the horizon of the shaded object, the covered area of the finest squares
// is integrated. For all other shapes, squares are classified by separating planes, and the finest
// squares that the boundary may cross are sampled by rays.

#include <renderer/light/light.h>
#include <renderer/shapes/shapes.h>

#include <wavelet/product/region.h>

#include <span>
#include <vector>

namespace haarlight::renderer {

namespace detail {
struct Occluder;
}

/// Makes visibility trees; thread-safe.
///
/// All trees have a single channel, float coefficients and values in [0, 1]: averages over the
/// finest squares, of side 2^-levels. Rays start at the hit, offset along its normal as in
/// <renderer/shapes/shape.h>; the normal must point to the viewer's side.
class VisibilityTrees {
public:
  /// @param shapes, light must outlive this
  VisibilityTrees(const ShapeSet& shapes, const Light& light);
  ~VisibilityTrees();
  VisibilityTrees(const VisibilityTrees&) = delete;
  VisibilityTrees& operator=(const VisibilityTrees&) = delete;

  /// v_j of an object: 0 in directions whose ray hits it, else 1, on the whole sphere.
  /// @param object not from.object
  /// @param levels 0 … 15
  wavelet::Tree object(int object, const Hit& from, int levels) const;
  /// The same; reuses the memory of a builder and a tree.
  void object(int object, const Hit& from, int levels, wavelet::RegionTreeBuilder& builder,
              wavelet::Tree& out) const;

  /// Whether an object may occlude directions above the horizon: not if it lies below the horizon,
  /// or if it is the shaded object and convex.
  bool may_hide(int object, const Hit& from) const;

  /// v_1 of the shaded object itself: 0 below the horizon and where it occludes itself. For
  /// products with reflectances that include the cosine.
  wavelet::Tree own(const Hit& from, int levels) const;
  /// The same; reuses the memory of a builder and a tree.
  void own(const Hit& from, int levels, wavelet::RegionTreeBuilder& builder,
           wavelet::Tree& out) const;

private:
  bool shadows_itself(int object) const;

  const Light& m_light;
  std::vector<detail::Occluder> m_occluders; ///< by object
};

/// The visibilities of all objects that may occlude a point, for one point after another; one per
/// thread. For products with reflectances that include the cosine, and thereby the horizon.
class OccluderTrees {
public:
  /// @param visibility must outlive this
  /// @param objects    number of the scene's objects
  OccluderTrees(const VisibilityTrees& visibility, int objects, int levels)
      : m_visibility(visibility), m_levels(levels), m_trees(static_cast<std::size_t>(objects)) {}

  /// Trees that are 1 everywhere are left out. Valid until the next call.
  /// @param without an object that counts as absent; −1: none
  std::span<const wavelet::TreeView> at(const Hit& hit, int without = -1);

private:
  const VisibilityTrees& m_visibility;
  int m_levels;
  wavelet::RegionTreeBuilder m_builder;
  std::vector<wavelet::Tree> m_trees; ///< by object
  std::vector<wavelet::TreeView> m_views;
};

} // namespace haarlight::renderer
