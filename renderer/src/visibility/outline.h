#pragma once
// The directions from a point in which a box may lie, by planes through the point and the box's
// silhouette.

#include <renderer/shapes/shapes.h>
#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

#include <array>

namespace haarlight::renderer::detail {

/// Six planes at most, some of them twice; all directions to the box are on the positive side of
/// each.
struct Outline {
  std::array<Float4, 2> x = {}; ///< unit normals; all zero from within
  std::array<Float4, 2> y = {};
  std::array<Float4, 2> z = {};

  void set(int plane, const Vec3& normal) {
    const auto batch = static_cast<std::size_t>(plane / 4);
    x[batch][plane % 4] = normal.x();
    y[batch][plane % 4] = normal.y();
    z[batch][plane % 4] = normal.z();
  }

  /// Where the squares of a cap's bounds lie; Inside if all of them is behind the box.
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

/// Of the box around a solid; of no planes from within that.
/// @param origin of the directions, in the world
/// @param to_frame rotation from the world to the frame of the directions
Outline outline_of(const Solid& solid, const Eigen::Vector3d& origin,
                   const Eigen::Matrix3f& to_frame);

} // namespace haarlight::renderer::detail
