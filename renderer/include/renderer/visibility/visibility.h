#pragma once
// What hides the light from a point, as trees: the visibilities v_j of the paper's eqs. 10-13, each
// the function of one object, all in the light's frame, so that light, reflectance and visibilities
// multiply square by square.
//
// Spheres and planes, and the horizon of the shaded object, have boundaries of which the coverage
// of the finest squares is integrated; all other shapes are told apart from squares by planes that
// separate them, and rays sample the finest squares that the boundary may cross.

#include <renderer/light/light.h>
#include <renderer/shapes/shapes.h>

#include <wavelet/product/region.h>

#include <vector>

namespace haarlight::renderer {

namespace detail {
struct Occluder;
}

/// Makes visibility trees. Any number of threads may ask one of these, which keeps nothing between
/// the questions.
///
/// All trees are of a single channel, with float coefficients and values in [0, 1]: averages over
/// the finest squares, of side 2^-levels. Rays start at the hit, moved off its surface to the side
/// of its normal as in <renderer/shapes/ray.h>; the normal has to point to the side that is seen.
class VisibilityTrees {
public:
  /// @param shapes, light must outlive this
  VisibilityTrees(const ShapeSet& shapes, const Light& light);
  ~VisibilityTrees();
  VisibilityTrees(const VisibilityTrees&) = delete;
  VisibilityTrees& operator=(const VisibilityTrees&) = delete;

  /// v_j: 1 where a ray into a direction misses an object, 0 where it meets it, on the whole
  /// sphere.
  /// @param object not from.object
  /// @param levels 0 … 15
  wavelet::Tree object(int object, const Hit& from, int levels) const;
  /// The same with a builder and a tree whose memory is used again.
  void object(int object, const Hit& from, int levels, wavelet::RegionTreeBuilder& builder,
              wavelet::Tree& out) const;

  /// Whether an object may be in the way of light above the horizon: no if all of it lies below,
  /// or if it is the shaded one and convex.
  bool may_hide(int object, const Hit& from) const;

  /// v_1 of the shaded object itself: 0 below the horizon and where the object is in its own way.
  /// For products with reflectances that hold the cosine, as this toolkit's maps do.
  wavelet::Tree own(const Hit& from, int levels) const;
  /// The same with a builder and a tree whose memory is used again.
  void own(const Hit& from, int levels, wavelet::RegionTreeBuilder& builder,
           wavelet::Tree& out) const {
    own(from, levels, false, builder, out);
  }

  /// v_1 · max(0, n·ω), the paper's local visibility (eqs. 10 and 11): for products with f_r alone.
  wavelet::Tree local(const Hit& from, int levels) const;

private:
  bool shadows_itself(int object) const;
  void own(const Hit& from, int levels, bool cosine, wavelet::RegionTreeBuilder& builder,
           wavelet::Tree& out) const;

  const Light& m_light;
  std::vector<detail::Occluder> m_occluders; ///< by object
};

} // namespace haarlight::renderer
