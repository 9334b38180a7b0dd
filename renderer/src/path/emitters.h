#pragma once
// The objects of a scene that shine and can be sampled: spheres by the cone of directions they
// fill, disks and boxes by area, of a box those faces that look towards the point.
//
// Other shapes, ellipsoids and planes among them, and any shape seen from inside or by itself, are
// found by following the reflectance alone; their density here is 0.

#include <renderer/scene/scene.h>
#include <renderer/shapes/shapes.h>

#include <optional>
#include <vector>

namespace haarlight::renderer {

/// An object that shines.
struct Emitter {
  detail::Solid solid;
  float luminance = 0;
  Vec3 center = Vec3::Zero();     ///< of a sphere around it
  float radius = 0;               ///< of that sphere
  Vec3 face_areas = Vec3::Zero(); ///< world areas of a box's faces across x, y, z; of a disk in z
};

/// A way to an emitter. Whether anything else stands in it, tracing tells.
struct EmitterDirection {
  Vec3 direction = Vec3::UnitZ(); ///< unit, world
  int object = -1;                ///< the emitter's
};

class Emitters {
public:
  /// @param scene whose shapes were added to its ShapeSet in order
  explicit Emitters(const SceneDescription& scene);

  bool empty() const { return m_emitters.empty(); }

  /// Chooses an emitter in proportion to luminance times about the solid angle it fills, and in it
  /// a direction; nothing if there is none to sample above the point's horizon.
  /// @param from     a surface point, its normal on the side that light is wanted on
  /// @param choice,u uniform in [0, 1)
  std::optional<EmitterDirection> sample(const Hit& from, float choice, const Vec2& u) const;

  /// Density of sample() at a direction in which `hit` is the first thing from `from`, sr⁻¹.
  float pdf(const Hit& from, const Vec3& direction, const Hit& hit) const;

private:
  std::vector<Emitter> m_emitters;
};

} // namespace haarlight::renderer
