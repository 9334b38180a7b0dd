#pragma once
// Fast conservative estimates of the visible fraction of squares from a point, for samplers.

#include "visibility/cap.h"

#include <renderer/shapes/shapes.h>
#include <renderer/visibility/visibility.h>

#include <wavelet/product/adaptive_product.h>
#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

#include <array>
#include <vector>

namespace haarlight::renderer::detail {
/// The directions from a point to a box, bounded by the planes through the point and the box's
/// silhouette edges: at most six planes, some stored twice; all directions to the box are on the
/// positive side of each.
struct Outline {
  std::array<Float4, 2> x = {}; ///< unit normals; all zero from inside the box
  std::array<Float4, 2> y = {};
  std::array<Float4, 2> z = {};

  void set(int plane, const Vec3& normal) {
    const auto batch = static_cast<std::size_t>(plane / 4);
    x[batch][plane % 4] = normal.x();
    y[batch][plane % 4] = normal.y();
    z[batch][plane % 4] = normal.z();
  }

  /// Classifies a square by its bounding cap; Inside if the box occludes all of it.
  wavelet::RegionPart classify(const wavelet::SquareCap& bounds) const {
    Int4 beside = {};
    Int4 within = ~beside;
    for (std::size_t i = 0; i < 2; ++i) {
      const Float4 height =
          x[i] * bounds.centre.x() + y[i] * bounds.centre.y() + z[i] * bounds.centre.z();
      beside |= height < broadcast<Float4>(-bounds.sine);
      within &= height > broadcast<Float4>(bounds.sine);
    }
    if ((beside[0] | beside[1] | beside[2] | beside[3]) != 0)
      return wavelet::RegionPart::Outside;
    return (within[0] & within[1] & within[2] & within[3]) != 0 ? wavelet::RegionPart::Inside
                                                                : wavelet::RegionPart::Partial;
  }
};

/// A possible occluder, as seen from a point; directions in the light's frame.
struct Obstacle {
  Cap bounds;      ///< contains all occluded directions
  Outline outline; ///< of the solid's bounding box
  const Solid* solid =
      nullptr; ///< tested by rays; null: all directions within the bounds are occluded
  Vec3 origin; ///< the point in the solid's frame
  Eigen::Matrix3f to_object; ///< of directions
};

/// Squares within the outline of a sphere or a box, behind a plane, or outside all outlines are
/// classified exactly; of other squares eight points are tested against all objects.
class ConservativeVisibility final : public wavelet::SquareVisibility {
public:
  /// @param shapes, light must outlive this
  ConservativeVisibility(const ShapeSet& shapes, const Light& light);

  /// @param from its normal points to the viewer's side
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
