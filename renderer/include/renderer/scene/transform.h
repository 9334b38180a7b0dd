#pragma once
// Affine maps of space, in double: they are set up once and used at every ray.

#include <wavelet/base/geometry.h>

namespace haarlight::renderer {

/// p ↦ linear·p + offset, right-handed world axes, column vectors.
struct Transform {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();

  Eigen::Vector3d point(const Eigen::Vector3d& p) const { return linear * p + offset; }
  Eigen::Vector3d vector(const Eigen::Vector3d& v) const { return linear * v; }

  /// This map first, `next` after it.
  Transform then(const Transform& next) const {
    return {next.linear * linear, next.linear * offset + next.offset};
  }

  /// The map is finite and neither it nor its inverse exceeds 1e18 anywhere.
  bool usable() const;

  /// The inverse of a usable map.
  Transform inverse() const;
};

Transform translation(const Eigen::Vector3d& by);

/// @param factors along x, y, z; none zero. Negative ones mirror.
Transform scaling(const Eigen::Vector3d& factors);

/// Right-handed rotation (counterclockwise seen against the axis).
/// @param axis of any length but zero
Transform rotation(const Eigen::Vector3d& axis, double degrees);

/// Rotation about x, then about the fixed y, then about the fixed z axis, in degrees.
Transform euler_rotation(const Eigen::Vector3d& degrees);

} // namespace haarlight::renderer
