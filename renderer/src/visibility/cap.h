#pragma once
// Spherical caps: the directions to a ball, or on one side of a plane.

#include <wavelet/product/region.h>
#include <wavelet/square/square_cap.h>

#include <cmath>

namespace haarlight::renderer::detail {
/// The directions within an angle in [0, π] of an axis.
struct Cap {
  Vec3 axis = Vec3::UnitZ(); ///< unit
  float cosine = 0;          ///< of the angle
  float sine = 1;
  float chord_squared = 2; ///< 2 − 2 cos, without cancellation

  static Cap half_space(const Vec3& axis) { return {axis, 0, 1, 2}; }

  /// The directions from the origin to a ball; all directions if the origin is inside.
  /// @param centre of the ball relative to the origin
  static Cap around_ball(const Eigen::Vector3d& centre, double radius);

  /// Classifies a square by its bounding cap.
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

inline Cap Cap::around_ball(const Eigen::Vector3d& centre, double radius) {
  const double distance = centre.norm();
  Cap cap;
  if (distance <= radius) {
    cap.cosine = -1;
    cap.sine = 0;
    cap.chord_squared = 4;
    return cap;
  }
  const double sine = radius / distance;
  const double cosine = std::sqrt((1 - sine) * (1 + sine));
  cap.axis = (centre / distance).cast<float>();
  cap.cosine = static_cast<float>(cosine);
  cap.sine = static_cast<float>(sine);
  cap.chord_squared = static_cast<float>(2 * sine * sine / (1 + cosine));
  return cap;
}

} // namespace haarlight::renderer::detail
