#include <renderer/shapes/shapes.h>

#include "shapes/solid.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace haarlight::renderer {

using namespace detail;
using Eigen::Vector3d;

namespace {

// Generous relative error bounds of float, for bounding radii and distances.
constexpr float bound_pad = 1e-5F;
constexpr float squared_pad = 1.01F;
constexpr float distance_pad = 1e-8F;

/// Tests a ray against four bounding spheres at a time.
class BoundTest {
public:
  explicit BoundTest(const Ray& ray) {
    for (int i = 0; i < 3; ++i) {
      m_origin[i] = broadcast<Float4>(ray.origin[i]);
      m_direction[i] = broadcast<Float4>(ray.direction[i]);
    }
  }

  /// Bit i: the ray may hit the solid in sphere i. Conservative.
  unsigned candidates(const BoundBatch& batch) const {
    const Float4 x = batch.x - m_origin[0];
    const Float4 y = batch.y - m_origin[1];
    const Float4 z = batch.z - m_origin[2];
    const Float4 along = x * m_direction[0] + y * m_direction[1] + z * m_direction[2];
    const Float4 px = x - along * m_direction[0];
    const Float4 py = y - along * m_direction[1];
    const Float4 pz = z - along * m_direction[2];
    const Float4 distance = x * x + y * y + z * z;
    const Float4 limit = batch.radius_squared + distance_pad * distance;
    const Int4 beside = px * px + py * py + pz * pz > limit;
    const Int4 behind = (along < broadcast<Float4>(0)) & (distance > limit);
    const Int4 bits = ~(beside | behind) & Int4{1, 2, 4, 8};
    return static_cast<unsigned>(bits[0] | bits[1] | bits[2] | bits[3]);
  }

private:
  Float4 m_origin[3];
  Float4 m_direction[3];
};

/// Calls visit(solid) for the solids that the ray may hit, until it returns true.
template <class Visit>
bool visit_candidates(const std::vector<BoundBatch>& bounds, const std::vector<Solid>& solids,
                      const Ray& ray, Visit visit) {
  const BoundTest test(ray);
  for (std::size_t batch = 0; batch < bounds.size(); ++batch)
    for (unsigned left = test.candidates(bounds[batch]); left != 0; left &= left - 1) {
      const std::size_t index = 4 * batch + static_cast<std::size_t>(std::countr_zero(left));
      if (index < solids.size() && visit(solids[index]))
        return true;
    }
  return false;
}

double sphere_distance(const Solid& sphere, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d o = origin - sphere.center;
  const double scale = 1 / direction.squaredNorm();
  const double middle = -o.dot(direction) * scale;
  const double inside = sphere.radius * sphere.radius - (o + middle * direction).squaredNorm();
  if (inside < 0)
    return no_hit;
  const double half = std::sqrt(inside * scale);
  return Interval{middle - half, middle + half}.first();
}

double solid_distance(const Solid& solid, const Ray& ray) {
  const Vector3d origin = ray.origin.cast<double>();
  const Vector3d direction = ray.direction.cast<double>();
  if (solid.kind == SolidKind::WorldSphere)
    return sphere_distance(solid, origin, direction);
  return canonical_distance(solid, solid.to_object.point(origin),
                            solid.to_object.vector(direction));
}

double plane_distance(const WorldPlane& plane, const Ray& ray) {
  const double above = plane.height - plane.normal.dot(ray.origin.cast<double>());
  const double t = above / plane.normal.dot(ray.direction.cast<double>());
  return t > 0 ? t : no_hit; // NaN, from a ray within the plane, is no hit
}

/// Upper bound on t, so that positions stay within float.
double limit(const Ray& ray) { return std::min(static_cast<double>(ray.t_max), 1e30); }

Vector3d point_at(const Ray& ray, double t) {
  return ray.origin.cast<double>() + t * ray.direction.cast<double>();
}

Hit make_hit(double t, const Vector3d& position, const Vector3d& normal, int object) {
  return {static_cast<float>(t), position.cast<float>(), normal.cast<float>(), object};
}

Hit plane_hit(const WorldPlane& plane, double t, const Vector3d& p) {
  const double off = plane.normal.dot(p) - plane.height;
  return make_hit(t, p - off * plane.normal, plane.normal, plane.object);
}

Hit solid_hit(const Solid& solid, double t, const Vector3d& p) {
  if (solid.kind == SolidKind::WorldSphere) {
    const Vector3d normal = (p - solid.center).normalized();
    return make_hit(t, solid.center + solid.radius * normal, normal, solid.object);
  }
  const SurfacePoint surface = canonical_surface(solid, solid.to_object.point(p));
  const Vector3d normal = solid.to_object.linear.transpose() * surface.normal;
  return make_hit(t, solid.to_world.point(surface.position), normal.stableNormalized(),
                  solid.object);
}

} // namespace

int ShapeSet::add(const Shape& shape, const AffineMap& transform) {
  assert(transform.usable());
  const int object = size();
  if (const Plane* plane = std::get_if<Plane>(&shape)) {
    m_planes.push_back(place_plane(*plane, transform));
    m_planes.back().object = object;
  } else {
    Solid solid = place_solid(shape, transform);
    solid.object = object;
    add_solid(solid);
  }
  return object;
}

bool ShapeSet::may_occlude(int object) const {
  return size() > 1 || std::any_of(m_solids.begin(), m_solids.end(), [&](const Solid& solid) {
           return solid.object == object && solid.kind == SolidKind::Torus;
         });
}

void ShapeSet::add_solid(Solid solid) {
  const std::size_t lane = m_solids.size() % 4;
  if (lane == 0)
    m_bounds.emplace_back();
  BoundBatch& batch = m_bounds.back();
  batch.x[lane] = static_cast<float>(solid.center.x());
  batch.y[lane] = static_cast<float>(solid.center.y());
  batch.z[lane] = static_cast<float>(solid.center.z());
  const auto reach = static_cast<float>(solid.center.cwiseAbs().maxCoeff() + solid.radius);
  const float radius = static_cast<float>(solid.radius) + bound_pad * reach;
  batch.radius_squared[lane] = squared_pad * radius * radius;
  m_solids.push_back(solid);
}

bool ShapeSet::intersect(const Ray& ray, Hit& hit) const {
  double nearest = limit(ray);
  const WorldPlane* nearest_plane = nullptr;
  const Solid* nearest_solid = nullptr;
  for (const WorldPlane& plane : m_planes) {
    const double t = plane_distance(plane, ray);
    nearest_plane = t < nearest ? &plane : nearest_plane;
    nearest = std::min(t, nearest);
  }
  visit_candidates(m_bounds, m_solids, ray, [&](const Solid& solid) {
    const double t = solid_distance(solid, ray);
    nearest_solid = t < nearest ? &solid : nearest_solid;
    nearest = std::min(t, nearest);
    return false;
  });
  if (nearest_solid != nullptr)
    hit = solid_hit(*nearest_solid, nearest, point_at(ray, nearest));
  else if (nearest_plane != nullptr)
    hit = plane_hit(*nearest_plane, nearest, point_at(ray, nearest));
  return nearest_solid != nullptr || nearest_plane != nullptr;
}

bool ShapeSet::occluded(const Ray& ray) const {
  const double t_max = limit(ray);
  for (const WorldPlane& plane : m_planes)
    if (plane_distance(plane, ray) < t_max)
      return true;
  return visit_candidates(m_bounds, m_solids, ray,
                          [&](const Solid& solid) { return solid_distance(solid, ray) < t_max; });
}

} // namespace haarlight::renderer
