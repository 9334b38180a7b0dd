#include "shapes/shape_canonical.h"

#include <algorithm>
#include <cmath>

namespace haarlight::renderer::detail {
namespace {

using Eigen::Vector3d;

constexpr Interval nowhere{no_hit, -no_hit};

/// A line counts as parallel to the axis when it drifts less than 1e-15 of its way from it.
bool parallel_to_z(double across_squared, const Vector3d& direction) {
  return across_squared < 1e-30 * direction.squaredNorm();
}

Interval unit_sphere(const Vector3d& o, const Vector3d& d) {
  const double scale = 1 / d.squaredNorm();
  const double middle = -o.dot(d) * scale;
  const double inside = 1 - (o + middle * d).squaredNorm();
  if (inside < 0)
    return nowhere;
  const double half = std::sqrt(inside * scale);
  return {middle - half, middle + half};
}

/// The infinite cylinder x² + y² ≤ 1.
Interval unit_tube(const Vector3d& o, const Vector3d& d) {
  const double across = d.x() * d.x() + d.y() * d.y();
  if (parallel_to_z(across, d))
    return o.x() * o.x() + o.y() * o.y() <= 1 ? Interval{} : nowhere;
  const double middle = -(o.x() * d.x() + o.y() * d.y()) / across;
  const double x = o.x() + middle * d.x();
  const double y = o.y() + middle * d.y();
  const double inside = 1 - x * x - y * y;
  if (inside < 0)
    return nowhere;
  const double half = std::sqrt(inside / across);
  return {middle - half, middle + half};
}

Interval cube(const Vector3d& o, const Vector3d& d) {
  return intersect(slab(o.x(), d.x(), 1), intersect(slab(o.y(), d.y(), 1), slab(o.z(), d.z(), 1)));
}

double disk_distance(const Vector3d& o, const Vector3d& d) {
  const double t = -o.z() / d.z();
  const double x = o.x() + t * d.x();
  const double y = o.y() + t * d.y();
  return t > 0 && x * x + y * y <= 1 ? t : no_hit; // NaN and infinity, from d.z = 0, are no hits
}

/// Both roots of a t² + 2 b t + c, by the form that does not cancel; missing ones are no_hit.
void quadratic_roots(double a, double b, double c, double roots[2]) {
  const double discriminant = b * b - a * c;
  roots[0] = roots[1] = no_hit;
  if (discriminant < 0)
    return;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  if (a != 0)
    roots[0] = q / a;
  if (q != 0)
    roots[1] = c / q;
}

double cone_distance(const Vector3d& o, const Vector3d& d) {
  // From the point of the line next to the shape: nothing cancels however far the ray starts.
  const double start = o.dot(d) / d.squaredNorm(); // the ray's own start, counted from there
  const Vector3d p = o - start * d;
  const double w = 1 - p.z();
  double candidates[3];
  quadratic_roots(d.x() * d.x() + d.y() * d.y() - d.z() * d.z(),
                  p.x() * d.x() + p.y() * d.y() + w * d.z(), p.x() * p.x() + p.y() * p.y() - w * w,
                  candidates);
  double nearest = no_hit;
  for (int i = 0; i < 2; ++i) {
    const double z = p.z() + candidates[i] * d.z();
    if (candidates[i] > start && z >= 0 && z <= 1)
      nearest = std::min(nearest, candidates[i]);
  }
  candidates[2] = -p.z() / d.z();
  const double x = p.x() + candidates[2] * d.x();
  const double y = p.y() + candidates[2] * d.y();
  if (candidates[2] > start && x * x + y * y <= 1)
    nearest = std::min(nearest, candidates[2]);
  return nearest - start;
}

SurfacePoint box_surface(const Vector3d& p) {
  int axis = 0;
  p.cwiseAbs().maxCoeff(&axis);
  SurfacePoint result{p, Vector3d::Zero()};
  result.position[axis] = result.normal[axis] = std::copysign(1.0, p[axis]);
  return result;
}

/// Unit vector across the axis towards p.
Vector3d away_from_axis(const Vector3d& p) {
  const double distance = std::sqrt(p.x() * p.x() + p.y() * p.y());
  return distance > 0 ? Vector3d(p.x() / distance, p.y() / distance, 0) : Vector3d(1, 0, 0);
}

SurfacePoint cylinder_surface(const Vector3d& p) {
  const Vector3d out = away_from_axis(p);
  if (std::abs(std::abs(p.z()) - 1) < std::abs(out.dot(p) - 1)) {
    const double z = std::copysign(1.0, p.z());
    return {{p.x(), p.y(), z}, {0, 0, z}};
  }
  return {{out.x(), out.y(), p.z()}, out};
}

SurfacePoint cone_surface(const Vector3d& p) {
  const Vector3d out = away_from_axis(p);
  const double w = 1 - p.z();
  if (std::abs(p.z()) < std::abs(out.dot(p) - w))
    return {{p.x(), p.y(), 0}, {0, 0, -1}};
  return {{w * out.x(), w * out.y(), p.z()}, {out.x(), out.y(), 1}};
}

SurfacePoint torus_surface(double tube, const Vector3d& p) {
  const Vector3d middle = away_from_axis(p);
  const Vector3d normal = (p - middle).normalized();
  return {middle + tube * normal, normal};
}

} // namespace

Interval slab(double origin, double direction, double half) {
  if (direction == 0)
    return std::abs(origin) <= half ? Interval{} : nowhere;
  const double a = (-half - origin) / direction;
  const double b = (half - origin) / direction;
  return a < b ? Interval{a, b} : Interval{b, a};
}

Interval intersect(const Interval& a, const Interval& b) {
  return {std::max(a.enter, b.enter), std::min(a.exit, b.exit)};
}

double canonical_distance(const Solid& shape, const Vector3d& origin, const Vector3d& direction) {
  switch (shape.kind) {
  case SolidKind::WorldSphere:
  case SolidKind::Sphere:
    return unit_sphere(origin, direction).first();
  case SolidKind::Disk:
    return disk_distance(origin, direction);
  case SolidKind::Box:
    return cube(origin, direction).first();
  case SolidKind::Cylinder:
    return intersect(unit_tube(origin, direction), slab(origin.z(), direction.z(), 1)).first();
  case SolidKind::Cone:
    return cone_distance(origin, direction);
  case SolidKind::Torus:
    return torus_distance(shape.tube, origin, direction);
  }
  return no_hit;
}

SurfacePoint canonical_surface(const Solid& shape, const Vector3d& p) {
  switch (shape.kind) {
  case SolidKind::WorldSphere:
  case SolidKind::Sphere:
    return {p.normalized(), p};
  case SolidKind::Disk:
    return {{p.x(), p.y(), 0}, {0, 0, 1}};
  case SolidKind::Box:
    return box_surface(p);
  case SolidKind::Cylinder:
    return cylinder_surface(p);
  case SolidKind::Cone:
    return cone_surface(p);
  case SolidKind::Torus:
    return torus_surface(shape.tube, p);
  }
  return {p, {0, 0, 1}};
}

double canonical_support(const Solid& shape, const Vector3d& n) {
  const double across = n.head<2>().norm();
  switch (shape.kind) {
  case SolidKind::Disk:
    return across;
  case SolidKind::Box:
    return n.cwiseAbs().sum();
  case SolidKind::Cylinder:
    return across + std::abs(n.z());
  case SolidKind::Cone:
    return std::max(across, n.z());
  case SolidKind::Torus:
    return across + shape.tube * n.norm();
  default:
    return n.norm();
  }
}

Bounds canonical_bounds(const Solid& shape) {
  switch (shape.kind) {
  case SolidKind::Disk:
    return {{-1, -1, 0}, {1, 1, 0}};
  case SolidKind::Cone:
    return {{-1, -1, 0}, {1, 1, 1}};
  case SolidKind::Torus: {
    const double reach = 1 + shape.tube;
    return {{-reach, -reach, -shape.tube}, {reach, reach, shape.tube}};
  }
  default:
    return {{-1, -1, -1}, {1, 1, 1}};
  }
}

} // namespace haarlight::renderer::detail
