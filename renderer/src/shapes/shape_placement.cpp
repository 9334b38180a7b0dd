#include "shapes/shape_placement.h"

#include "shapes/shape_canonical.h"

#include <cassert>
#include <cmath>

namespace haarlight::renderer::detail {
namespace {

using Eigen::Vector3d;

/// Maps the z axis to `axis` (its length kept), x and y to vectors of length `across` at right
/// angles to it, 0 to `origin`.
AffineMap placement(const Vec3& origin, const Vector3d& axis, double across) {
  const Vector3d n = axis.stableNormalized();
  const Vector3d other = std::abs(n.x()) < 0.7 ? Vector3d::UnitX() : Vector3d::UnitY();
  const Vector3d t = other.cross(n).normalized();
  AffineMap result;
  result.linear.col(0) = across * t;
  result.linear.col(1) = across * n.cross(t);
  result.linear.col(2) = axis;
  result.offset = origin.cast<double>();
  return result;
}

AffineMap canonical_to_shape(const Sphere& sphere) {
  return {sphere.radius * Eigen::Matrix3d::Identity(), sphere.center.cast<double>()};
}

AffineMap canonical_to_shape(const Disk& disk) {
  return placement(disk.center, disk.normal.cast<double>().stableNormalized(), disk.radius);
}

AffineMap canonical_to_shape(const Box& box) {
  const Vector3d low = box.low.cast<double>();
  const Vector3d high = box.high.cast<double>();
  return {Eigen::Matrix3d((0.5 * (high - low)).asDiagonal()), 0.5 * (low + high)};
}

AffineMap canonical_to_shape(const Cylinder& cylinder) {
  const Vector3d base = cylinder.base.cast<double>();
  const Vector3d half = 0.5 * (cylinder.top.cast<double>() - base);
  AffineMap result = placement(cylinder.base, half, cylinder.radius);
  result.offset += half;
  return result;
}

AffineMap canonical_to_shape(const Cone& cone) {
  return placement(cone.base, cone.apex.cast<double>() - cone.base.cast<double>(), cone.radius);
}

AffineMap canonical_to_shape(const Torus& torus) {
  const Vector3d axis = torus.axis.cast<double>().stableNormalized();
  return placement(torus.center, torus.major_radius * axis, torus.major_radius);
}

SolidKind kind_of(const Sphere&) { return SolidKind::Sphere; }
SolidKind kind_of(const Disk&) { return SolidKind::Disk; }
SolidKind kind_of(const Box&) { return SolidKind::Box; }
SolidKind kind_of(const Cylinder&) { return SolidKind::Cylinder; }
SolidKind kind_of(const Cone&) { return SolidKind::Cone; }
SolidKind kind_of(const Torus&) { return SolidKind::Torus; }

/// The factor of a map that turns, mirrors and scales alike in all directions; 0 of any other map.
double similarity_factor(const Eigen::Matrix3d& linear) {
  const Eigen::Matrix3d gram = linear.transpose() * linear;
  const double squared = gram.trace() / 3;
  const Eigen::Matrix3d rest = gram - squared * Eigen::Matrix3d::Identity();
  return rest.cwiseAbs().maxCoeff() <= 1e-12 * squared ? std::sqrt(squared) : 0;
}

void set_placement(Solid& solid, const AffineMap& to_world) {
  solid.to_world = to_world;
  solid.to_object = to_world.inverse();
  if (solid.kind == SolidKind::Sphere) {
    solid.center = to_world.offset;
    solid.radius = similarity_factor(to_world.linear);
    if (solid.radius > 0) {
      solid.kind = SolidKind::WorldSphere;
      return;
    }
  }
  const Bounds bounds = canonical_bounds(solid);
  solid.center = to_world.point(0.5 * (bounds.low + bounds.high));
  solid.radius = (to_world.linear.cwiseAbs() * (0.5 * (bounds.high - bounds.low))).norm();
}

} // namespace

Solid place_solid(const Shape& shape, const AffineMap& transform) {
  Solid solid;
  std::visit(
      [&](const auto& plain) {
        using Kind = std::decay_t<decltype(plain)>;
        if constexpr (!std::is_same_v<Kind, Plane>) { // planes have no placement
          solid.kind = kind_of(plain);
          if constexpr (std::is_same_v<Kind, Torus>)
            solid.tube = static_cast<double>(plain.minor_radius) / plain.major_radius;
          set_placement(solid, canonical_to_shape(plain).then(transform));
        }
      },
      shape);
  return solid;
}

WorldPlane place_plane(const Plane& plane, const AffineMap& transform) {
  const Vector3d normal = plane.normal.cast<double>().stableNormalized();
  const Vector3d turned = (transform.inverse().linear.transpose() * normal).stableNormalized();
  return {turned, turned.dot(transform.point(plane.point.cast<double>())), -1};
}

} // namespace haarlight::renderer::detail
