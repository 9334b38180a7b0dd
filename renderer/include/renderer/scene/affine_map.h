#pragma once
// Affine maps in double precision.

#include <wavelet/base/geometry.h>

namespace haarlight::renderer {

/// p ↦ linear·p + offset, right-handed world axes, column vectors.
struct AffineMap {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();

  Eigen::Vector3d point(const Eigen::Vector3d& p) const { return linear * p + offset; }
  Eigen::Vector3d vector(const Eigen::Vector3d& v) const { return linear * v; }

  /// The composition that applies this map first, then `next`.
  AffineMap then(const AffineMap& next) const {
    return {next.linear * linear, next.linear * offset + next.offset};
  }

  /// Whether the map and its inverse are finite with coefficients of at most 1e18.
  bool usable() const;

  /// The inverse of a usable map.
  AffineMap inverse() const;
};

AffineMap translation(const Eigen::Vector3d& by);

/// @param factors along x, y, z; none zero. Negative ones mirror.
AffineMap scaling(const Eigen::Vector3d& factors);

/// Right-handed rotation (counterclockwise seen against the axis).
/// @param axis of any length but zero
AffineMap rotation(const Eigen::Vector3d& axis, double degrees);

/// Rotation about x, then about the fixed y, then about the fixed z axis, in degrees.
AffineMap euler_rotation(const Eigen::Vector3d& degrees);

} // namespace haarlight::renderer
