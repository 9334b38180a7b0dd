#pragma once
// The emissive objects of a scene that are sampled: spheres by the cone of directions they subtend,
// disks and boxes by the area of the faces that are visible from the point.
//
// Other shapes, including ellipsoids and planes, and any shape seen from inside or by itself, are
// only found by BSDF samples; their density here is 0.

#include <renderer/scene/scene.h>
#include <renderer/shapes/shapes.h>

#include <optional>
#include <vector>

namespace haarlight::renderer {

/// An emissive object.
struct Emitter {
  detail::Solid solid;
  float luminance = 0;
  Vec3 center = Vec3::Zero();     ///< of the bounding sphere
  float radius = 0;               ///< of the bounding sphere
  Vec3 face_areas = Vec3::Zero(); ///< world areas of a box's faces across x, y, z; of a disk in z
};

/// Weight of the balance heuristic. @param own,other numbers of samples times density
inline float balance_heuristic(float own, float other) { return own / (own + other); }

/// A direction to an emitter, which may be occluded.
struct EmitterDirection {
  Vec3 direction = Vec3::UnitZ(); ///< unit, world
  int object = -1;                ///< of the emitter
};

class Emitters {
public:
  /// @param scene whose shapes were added to its ShapeSet in order
  explicit Emitters(const SceneDescription& scene);

  bool empty() const { return m_emitters.empty(); }

  /// Chooses an emitter in proportion to its luminance times its approximate solid angle, and a
  /// direction to it; none if no emitter lies above the point's horizon.
  /// @param from     a surface point, its normal on the illuminated side
  /// @param choice,u uniform in [0, 1)
  std::optional<EmitterDirection> sample(const Hit& from, float choice, const Vec2& u) const;

  /// Density of sample() in a direction, sr⁻¹. @param hit the first hit from `from` in it
  float pdf(const Hit& from, const Vec3& direction, const Hit& hit) const;

private:
  std::vector<Emitter> m_emitters;
};

} // namespace haarlight::renderer
