#include "visibility/ray_lanes.h"

#include <array>
#include <limits>

namespace haarlight::renderer::detail {
namespace {

constexpr float lane_infinity = std::numeric_limits<float>::infinity();

/// Avoids division by 0.
constexpr float tiny = 1e-20F;

/// The intervals of t in which four lines are inside a shape.
struct Spans {
  Float4 enter;
  Float4 exit;
};

Spans intersection(const Spans& a, const Spans& b) {
  return {larger(a.enter, b.enter), smaller(a.exit, b.exit)};
}

Int4 is_ahead(const Spans& spans) { return (spans.enter < spans.exit) & (spans.exit > Float4{}); }

/// The interval of t in which origin + t·direction lies in [−half, half] along one axis.
Spans slab_span(float origin, Float4 direction, float half) {
  const Float4 divisor =
      select(absolute(direction) > broadcast<Float4>(tiny), direction, broadcast<Float4>(tiny));
  const Float4 a = (-half - origin) / divisor;
  const Float4 b = (half - origin) / divisor;
  return {smaller(a, b), larger(a, b)};
}

/// a t² + 2 b t + c.
struct Quadratic {
  Float4 a, b, c;

  /// The interval where it is below 0, for a ≥ 0; empty without roots.
  Spans below() const {
    const Float4 square = b * b - a * c;
    const Float4 root = square_root(larger(square, Float4{}));
    const Int4 real = square > Float4{};
    return {select(real, (-b - root) / (a + tiny), broadcast<Float4>(lane_infinity)),
            select(real, (-b + root) / (a + tiny), broadcast<Float4>(-lane_infinity))};
  }
};

/// x² + y² − 1 along the rays.
Quadratic tube_quadratic(const Vec3& o, const Lanes3& d) {
  return {d.x * d.x + d.y * d.y, o.x() * d.x + o.y() * d.y,
          broadcast<Float4>(o.x() * o.x() + o.y() * o.y() - 1)};
}

Quadratic sphere_quadratic(const Vec3& o, const Lanes3& d) {
  const Quadratic tube = tube_quadratic(o, d);
  return {tube.a + d.z * d.z, tube.b + o.z() * d.z, tube.c + o.z() * o.z()};
}

Float4 squared_distance_to_axis(const Vec3& o, const Lanes3& d, Float4 t) {
  const Float4 x = o.x() + t * d.x;
  const Float4 y = o.y() + t * d.y;
  return x * x + y * y;
}

Int4 hits_disk(const Vec3& o, const Lanes3& d) {
  const Float4 t = -o.z() / d.z;
  return (t > Float4{}) & (squared_distance_to_axis(o, d, t) < broadcast<Float4>(1));
}

Int4 hits_box(const Vec3& o, const Lanes3& d) {
  return is_ahead(intersection(intersection(slab_span(o.x(), d.x, 1), slab_span(o.y(), d.y, 1)),
                               slab_span(o.z(), d.z, 1)));
}

Int4 hits_cylinder(const Vec3& o, const Lanes3& d) {
  return is_ahead(intersection(tube_quadratic(o, d).below(), slab_span(o.z(), d.z, 1)));
}

/// The base, or either root of the mantle's x² + y² − (1 − z)².
Int4 hits_cone(const Vec3& o, const Lanes3& d) {
  const float below_tip = 1 - o.z();
  const Float4 a = d.x * d.x + d.y * d.y - d.z * d.z;
  const Float4 b = o.x() * d.x + o.y() * d.y + below_tip * d.z;
  const float c = o.x() * o.x() + o.y() * o.y() - below_tip * below_tip;
  const Float4 square = b * b - a * c;
  const Float4 root = square_root(larger(square, Float4{}));
  Int4 result = hits_disk(o, d);
  for (const Float4 t : {(-b - root) / a, (-b + root) / a}) {
    const Float4 z = o.z() + t * d.z;
    result |= (square > Float4{}) & (t > Float4{}) & (z > Float4{}) & (z < broadcast<Float4>(1));
  }
  return result;
}

/// The t at which rays are closest to the point of the torus's circle closest to the ray at t.
Float4 next_closest(const Vec3& o, const Lanes3& d, Float4 t) {
  const Float4 x = o.x() + t * d.x;
  const Float4 y = o.y() + t * d.y;
  const Float4 scale = 1 / (square_root(x * x + y * y) + tiny);
  const Float4 along = (x * scale - o.x()) * d.x + (y * scale - o.y()) * d.y - o.z() * d.z;
  return along / (d.x * d.x + d.y * d.y + d.z * d.z);
}

/// Tests the ray at its local closest points to the torus's circle, found by fixed-point iteration
/// from the ray's points above or below the circle and from its intersection with the plane.
Int4 hits_torus(float tube, const Vec3& o, const Lanes3& d) {
  const Quadratic circle = tube_quadratic(o, d);
  const Float4 nearest = -circle.b / (circle.a + tiny);
  const Float4 off =
      square_root(larger(circle.b * circle.b - circle.a * circle.c, Float4{})) / (circle.a + tiny);
  Int4 result = {};
  for (Float4 t : {nearest - off, nearest + off, -o.z() / d.z}) {
    for (int turn = 0; turn < 3; ++turn)
      t = next_closest(o, d, t);
    const Float4 beside = square_root(squared_distance_to_axis(o, d, t)) - 1;
    const Float4 z = o.z() + t * d.z;
    result |= (t > Float4{}) & (beside * beside + z * z < broadcast<Float4>(tube * tube));
  }
  return result;
}

} // namespace

Int4 rays_hit(const Solid& solid, const Vec3& origin, const Lanes3& directions) {
  switch (solid.kind) {
  case SolidKind::Disk:
    return hits_disk(origin, directions);
  case SolidKind::Box:
    return hits_box(origin, directions);
  case SolidKind::Cylinder:
    return hits_cylinder(origin, directions);
  case SolidKind::Cone:
    return hits_cone(origin, directions);
  case SolidKind::Torus:
    return hits_torus(static_cast<float>(solid.tube), origin, directions);
  case SolidKind::WorldSphere:
  case SolidKind::Sphere:
    break;
  }
  return is_ahead(sphere_quadratic(origin, directions).below());
}

} // namespace haarlight::renderer::detail
