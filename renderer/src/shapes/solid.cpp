#include "shapes/solid.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haarlight::renderer::detail {
namespace {

constexpr double wider = 1.0001;

/// t⁴ + p t² + q t + r.
struct DepressedQuartic {
  double p;
  double q;
  double r;

  double value(double t) const { return ((t * t + p) * t + q) * t + r; }
  double slope(double t) const { return (4 * t * t + 2 * p) * t + q; }
  double curvature(double t) const { return 12 * t * t + 2 * p; }
};

/// The root of a function that is monotone on [low, high] and changes sign there: Newton's method,
/// with bisection where a step leaves the bracket.
template <class Value, class Slope>
double bracketed_root(double low, double high, double tolerance, Value value, Slope slope) {
  const bool rises = value(high) > 0;
  double t = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    const double f = value(t);
    ((f > 0) == rises ? high : low) = t;
    double next = t - f / slope(t);
    if (!(next >= low && next <= high))
      next = 0.5 * (low + high);
    const double step = std::abs(next - t);
    t = next;
    if (step <= tolerance)
      break;
  }
  return t;
}

bool changes_sign(double a, double b) { return (a > 0) != (b > 0); }

/// Searches the monotone intervals of the quartic for a sign change.
class RootSearch {
public:
  RootSearch(const DepressedQuartic& quartic, double begin)
      : m_quartic(quartic), m_from(begin), m_value(quartic.value(begin)) {}

  /// Searches up to `to`. @return whether root() was found
  bool reaches(double to) {
    const double value = m_quartic.value(to);
    if (!changes_sign(m_value, value)) {
      m_from = to;
      m_value = value;
      return false;
    }
    m_root = bracketed_root(
        m_from, to, 4e-16, [&](double t) { return m_quartic.value(t); },
        [&](double t) { return m_quartic.slope(t); });
    return true;
  }

  /// Searches up to an extremum between `low` and `high`, if there is one.
  bool passes_extremum(double low, double high) {
    if (!(low < high) || !changes_sign(m_quartic.slope(low), m_quartic.slope(high)))
      return false;
    return reaches(bracketed_root(
        low, high, 1e-10, [&](double t) { return m_quartic.slope(t); },
        [&](double t) { return m_quartic.curvature(t); }));
  }

  double root() const { return m_root; }

private:
  const DepressedQuartic& m_quartic;
  double m_from;
  double m_value;
  double m_root = no_hit;
};

/// The smallest root in (low, high), or no_hit.
double first_root(const DepressedQuartic& quartic, double low, double high) {
  RootSearch search(quartic, low);
  const double turn = quartic.p < 0 ? std::sqrt(quartic.p / -6) : 0; // where the slope has extrema
  const double left = std::clamp(-turn, low, high);
  const double right = std::clamp(turn, low, high);
  const bool found = search.passes_extremum(low, left) || search.passes_extremum(left, right) ||
                     search.passes_extremum(right, high) || search.reaches(high);
  return found ? search.root() : no_hit;
}

using Eigen::Vector3d;

constexpr Interval nowhere{no_hit, -no_hit};

/// Whether a line deviates from the z axis by less than 1e-15 of its length.
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

/// Both roots of a t² + 2 b t + c, computed without cancellation; missing ones are no_hit.
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
  // Relative to the line's point nearest to the centre, to avoid cancellation for distant origins.
  const double start = o.dot(d) / d.squaredNorm(); // of the ray's origin, relative to that point
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

/// Unit vector from the axis to p, perpendicular to the axis.
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

using Eigen::Vector3d;

/// Maps the z axis to `axis`, including its length, x and y to perpendicular vectors of length
/// `across`, and 0 to `origin`.
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

/// The scale factor of a similarity; 0 for any other map.
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

double torus_distance(double tube, const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction) {
  const double length = direction.norm();
  const Eigen::Vector3d d = direction / length;
  const double start = origin.dot(d);
  const Eigen::Vector3d o = origin - start * d;
  const double away = o.squaredNorm();
  // Slightly larger than the torus, so that no search starts on its surface.
  const double reach = wider * (1 + tube) * (1 + tube) - away;
  if (reach <= 0)
    return no_hit;
  const double half = std::sqrt(reach);
  const Interval span = intersect(slab(o.z(), d.z(), wider * tube), {std::max(start, -half), half});
  if (!(span.enter < span.exit))
    return no_hit;
  // (|p|² + 1 − tube²)² = 4 (x² + y²), with |p|² = t² + away.
  const double k = away + 1 - tube * tube;
  const DepressedQuartic quartic{2 * k - 4 * (d.x() * d.x() + d.y() * d.y()),
                                 -8 * (o.x() * d.x() + o.y() * d.y()),
                                 k * k - 4 * (o.x() * o.x() + o.y() * o.y())};
  return (first_root(quartic, span.enter, span.exit) - start) / length;
}

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
