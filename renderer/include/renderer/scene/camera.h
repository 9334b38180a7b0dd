#pragma once
// From film coordinates to rays.

#include <renderer/scene/scene.h>
#include <renderer/shapes/shape.h>

namespace haarlight::renderer {

/// A pinhole or orthographic camera with square pixels. Film coordinates are in pixels: (0, 0) is
/// the top left corner of the picture, x runs to the right and y down, so the centre of pixel (x,
/// y) is (x + 0.5, y + 0.5).
class Camera {
public:
  /// @param description with distinct from and to, and up not parallel to their line
  /// @param width,height of the film in pixels; fov and height span its vertical side
  Camera(const CameraDescription& description, int width, int height);

  /// The ray of a film point. Perspective rays start at `from`, orthographic ones on the plane
  /// through `from` perpendicular to the view.
  Ray generate_ray(float x, float y) const;

private:
  CameraProjection m_projection;
  Vec3 m_from;
  Vec3 m_forward;
  Vec3 m_corner; // top left of the film, relative to `from`
  Vec3 m_across; // one pixel to the right
  Vec3 m_down;   // one pixel down
};

} // namespace haarlight::renderer
