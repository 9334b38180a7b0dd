#include <renderer/scene/camera.h>

#include <wavelet/base/elementary.h>

#include <cassert>

namespace haarlight::renderer {
namespace {

/// Half the picture's height at distance 1 from the eye, or on the film plane if orthographic.
double half_height(const CameraDescription& description) {
  if (description.projection == CameraProjection::Orthographic)
    return 0.5 * description.height;
  const SineCosine half = sine_cosine_degrees(0.5 * description.fov);
  return half.sine / half.cosine;
}

} // namespace

Camera::Camera(const CameraDescription& description, int width, int height)
    : m_projection(description.projection), m_from(description.from) {
  assert(width > 0 && height > 0);
  const Eigen::Vector3d view = (description.to - description.from).cast<double>();
  const Eigen::Vector3d forward = view.stableNormalized();
  const Eigen::Vector3d right =
      forward.cross(description.up.cast<double>().stableNormalized()).stableNormalized();
  const Eigen::Vector3d up = right.cross(forward);
  const double pixel = 2 * half_height(description) / height;
  const Eigen::Vector3d corner = pixel * (0.5 * height * up - 0.5 * width * right);
  const bool perspective = m_projection == CameraProjection::Perspective;
  m_forward = forward.cast<float>();
  m_corner = (perspective ? Eigen::Vector3d(forward + corner) : corner).cast<float>();
  m_across = (pixel * right).cast<float>();
  m_down = (-pixel * up).cast<float>();
}

Ray Camera::generate_ray(float x, float y) const {
  const Vec3 film = m_corner + x * m_across + y * m_down;
  if (m_projection == CameraProjection::Perspective)
    return {m_from, film.normalized()};
  return {m_from + film, m_forward};
}

} // namespace haarlight::renderer
