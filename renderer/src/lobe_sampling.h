#pragma once
// Sampling a reflectance alone: descent in the tree of the nearest θ_r cell, in the reflection
// frame.

#include <renderer/material.h>
#include <renderer/sampler.h>

#include <wavelet/descent.h>
#include <wavelet/sphere_map.h>

namespace haarlight::renderer {

/// A material's lobe at a point. Densities in sr⁻¹.
class Lobe {
public:
  void prepare(const ShadingPoint& point, const Material& material) {
    m_density = wavelet::TreeDensity::of(material.lobe(point));
    m_frame = point.reflection.frame;
  }

  DirectionSample sample(const Vec2& u) const {
    wavelet::Descent d;
    d.u1 = u.x();
    d.u2 = u.y();
    wavelet::descend_tree(d, m_density);
    const Vec3 local = wavelet::square_to_sphere(wavelet::end_point(d));
    return {m_frame.to_outer(local), d.pdf / wavelet::sphere_area};
  }

  float pdf(const Vec3& direction) const {
    const Vec2 p = wavelet::sphere_to_square(m_frame.to_local(direction));
    wavelet::Descent d;
    wavelet::follow_tree(d, m_density, p.x(), p.y());
    return d.pdf / wavelet::sphere_area;
  }

private:
  wavelet::TreeDensity m_density;
  Frame m_frame;
};

} // namespace haarlight::renderer
