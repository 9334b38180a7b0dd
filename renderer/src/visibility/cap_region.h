#pragma once
// Everything within a circle on the sphere, or everything outside of it.

#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

namespace haarlight::renderer::detail {

/// The directions within an angle, in [0, π], of an axis.
struct Cap {
  Vec3 axis = Vec3::UnitZ(); ///< unit
  float cosine = 0;          ///< of the angle
  float sine = 1;
  float chord_squared = 2; ///< 2 − 2 cos, without cancellation

  static Cap half_space(const Vec3& axis) { return {axis, 0, 1, 2}; }

  /// The directions from `origin` to a ball; all of them from within it.
  /// @param centre of the ball, seen from the origin
  static Cap around_ball(const Eigen::Vector3d& centre, double radius);

  /// Where the squares of a cap's bounds lie.
  wavelet::RegionPart classify(const wavelet::SquareCap& bounds) const {
    const float along = axis.dot(bounds.centre);
    const float even = cosine * bounds.cosine;
    const float odd = sine * bounds.sine;
    if (chord_squared >= 4)
      return wavelet::RegionPart::Inside;
    if (cosine <= bounds.cosine && along >= even + odd)
      return wavelet::RegionPart::Inside;
    if (cosine >= -bounds.cosine && along <= even - odd)
      return wavelet::RegionPart::Outside;
    return wavelet::RegionPart::Partial;
  }
};

/// 1 within the cap and 0 outside, or the reverse.
class CapRegion final : public wavelet::Region {
public:
  CapRegion(const Cap& cap, bool reverse) : m_cap(cap), m_reverse(reverse) {}

  wavelet::RegionPart classify(const wavelet::Square& square) const override;
  float coverage(const wavelet::Square& square) const override;

private:
  Cap m_cap;
  bool m_reverse;
};

} // namespace haarlight::renderer::detail
