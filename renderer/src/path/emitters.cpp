#include "path/emitters.h"

#include "shapes/solid.h"

#include <wavelet/base/sampling.h>

#include <algorithm>
#include <cmath>

namespace haarlight::renderer {

using namespace detail;

namespace {

bool can_sample(const Solid& solid) {
  return solid.kind == SolidKind::WorldSphere || solid.kind == SolidKind::Disk ||
         solid.kind == SolidKind::Box;
}

/// The image of a canonical axis, world.
Vec3 axis_of(const Emitter& emitter, int axis) {
  return emitter.solid.to_world.linear.col(axis).cast<float>();
}

/// Half the edges of a box's face across an axis, or two radii of a disk.
struct Edges {
  Vec3 first;
  Vec3 second;
};
Edges edges_across(const Emitter& emitter, int axis) {
  return {axis_of(emitter, (axis + 1) % 3), axis_of(emitter, (axis + 2) % 3)};
}

float area_across(const Emitter& emitter, int axis) {
  const Edges edges = edges_across(emitter, axis);
  return edges.first.cross(edges.second).norm();
}

Emitter make_emitter(const Solid& solid, float luminance) {
  Emitter emitter;
  emitter.solid = solid;
  emitter.luminance = luminance;
  emitter.center = solid.center.cast<float>();
  emitter.radius = static_cast<float>(solid.radius);
  if (solid.kind == SolidKind::Disk)
    emitter.face_areas.z() = pi * area_across(emitter, 2);
  if (solid.kind == SolidKind::Box)
    for (int axis = 0; axis < 3; ++axis)
      emitter.face_areas[axis] = 4 * area_across(emitter, axis);
  return emitter;
}

/// Per axis: +1 or −1 if the face on that side is visible from the point, 0 if neither is.
Vec3 sides_towards(const Emitter& emitter, const Vec3& position) {
  const Vec3 local = emitter.solid.to_object.point(position.cast<double>()).cast<float>();
  if (emitter.solid.kind == SolidKind::Disk)
    return {0, 0, local.z() > 0 ? 1.0F : local.z() < 0 ? -1.0F : 0.0F};
  Vec3 sides;
  for (int axis = 0; axis < 3; ++axis)
    sides[axis] = local[axis] > 1 ? 1.0F : local[axis] < -1 ? -1.0F : 0.0F;
  return sides;
}

/// World area of the faces visible from the point.
float area_towards(const Emitter& emitter, const Vec3& position) {
  return sides_towards(emitter, position).cwiseAbs().dot(emitter.face_areas);
}

/// 1 − cos of the half angle that the bounding sphere subtends; 2 from inside.
float cap_height(const Emitter& emitter, const Vec3& position) {
  const float distance2 = (emitter.center - position).squaredNorm();
  const float sine2 = emitter.radius * emitter.radius / distance2;
  return sine2 < 1 ? sine2 / (1 + std::sqrt(1 - sine2)) : 2.0F;
}

/// Approximate solid angle / 2π.
float extent(const Emitter& emitter, const Vec3& position) {
  const float height = cap_height(emitter, position);
  if (emitter.solid.kind == SolidKind::WorldSphere)
    return height < 2 ? height : 0.0F; // from inside it is not sampled
  const float distance2 = (emitter.center - position).squaredNorm();
  const float area = area_towards(emitter, position);
  return area > 0 ? std::min(height, area / (2 * pi * distance2)) : 0.0F;
}

/// Unnormalised probability of choosing an emitter.
float importance(const Emitter& emitter, const Hit& from) {
  const bool below = from.normal.dot(emitter.center - from.position) < -emitter.radius;
  if (below || emitter.solid.object == from.object)
    return 0;
  return emitter.luminance * extent(emitter, from.position);
}

Vec3 cone_direction(const Emitter& emitter, const Vec3& position, const Vec2& u) {
  const float down = u.x() * cap_height(emitter, position);
  const float across = std::sqrt(down * (2 - down));
  float sine = 0;
  float cosine = 1;
  sine_cosine(2 * pi * u.y(), sine, cosine);
  const Frame frame = frame_about((emitter.center - position).normalized());
  return frame.to_outer({across * cosine, across * sine, 1 - down}).normalized();
}

/// A point on the faces visible from `position`, uniform in area.
Vec3 area_point(const Emitter& emitter, const Vec3& position, Vec2 u) {
  const Vec3 sides = sides_towards(emitter, position);
  const Vec3 areas = sides.cwiseAbs().cwiseProduct(emitter.face_areas);
  float place = u.x() * areas.sum();
  int axis = 0;
  while (axis < 2 && place >= areas[axis])
    place -= areas[axis++];
  u.x() = std::clamp(place / areas[axis], 0.0F, 1.0F);
  const bool disk = emitter.solid.kind == SolidKind::Disk;
  const Vec2 p = disk ? sample_disk(u) : Vec2(2 * u - Vec2::Ones());
  const Edges edges = edges_across(emitter, axis);
  const Vec3 center = emitter.solid.to_world.offset.cast<float>();
  return center + p.x() * edges.first + p.y() * edges.second +
         (disk ? 0.0F : sides[axis]) * axis_of(emitter, axis);
}

Vec3 direction_to(const Emitter& emitter, const Vec3& position, const Vec2& u) {
  if (emitter.solid.kind == SolidKind::WorldSphere)
    return cone_direction(emitter, position, u);
  return (area_point(emitter, position, u) - position).normalized();
}

/// Of direction_to(), sr⁻¹.
float density(const Emitter& emitter, const Vec3& position, const Vec3& direction, const Hit& hit) {
  if (emitter.solid.kind == SolidKind::WorldSphere)
    return 1 / (2 * pi * cap_height(emitter, position));
  const float cosine = std::abs(hit.normal.dot(direction));
  const float area = area_towards(emitter, position);
  const float distance2 = (hit.position - position).squaredNorm();
  return area > 0 && cosine > 0 ? distance2 / (area * cosine) : 0.0F;
}

} // namespace

Emitters::Emitters(const SceneDescription& scene) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const ObjectDescription& object = scene.objects[i];
    const MaterialDescription& material =
        scene.materials[static_cast<std::size_t>(object.material)];
    const float y = luminance(material.emission);
    if (!(y > 0) || std::holds_alternative<Plane>(object.shape))
      continue;
    Solid solid = place_solid(object.shape, object.transform);
    solid.object = static_cast<int>(i);
    if (can_sample(solid))
      m_emitters.push_back(make_emitter(solid, y));
  }
}

std::optional<EmitterDirection> Emitters::sample(const Hit& from, float choice,
                                                 const Vec2& u) const {
  float total = 0;
  for (const Emitter& emitter : m_emitters)
    total += importance(emitter, from);
  float place = choice * total;
  const Emitter* chosen = nullptr;
  for (const Emitter& emitter : m_emitters) {
    const float weight = importance(emitter, from);
    if (weight > 0)
      chosen = &emitter; // rounding may leave `place` beyond the last
    if (weight > 0 && place < weight)
      break;
    place -= weight;
  }
  if (chosen == nullptr)
    return std::nullopt;
  return EmitterDirection{direction_to(*chosen, from.position, u), chosen->solid.object};
}

float Emitters::pdf(const Hit& from, const Vec3& direction, const Hit& hit) const {
  float total = 0;
  float weight = 0;
  const Emitter* found = nullptr;
  for (const Emitter& emitter : m_emitters) {
    const float own = importance(emitter, from);
    total += own;
    if (emitter.solid.object != hit.object)
      continue;
    weight = own;
    found = &emitter;
  }
  return weight > 0 ? weight / total * density(*found, from.position, direction, hit) : 0.0F;
}

} // namespace haarlight::renderer
