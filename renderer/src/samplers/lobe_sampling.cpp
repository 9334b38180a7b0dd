#include "samplers/lobe_sampling.h"

#include <wavelet/square/sphere_map.h>

namespace haarlight::renderer {

void Lobe::prepare(const ShadingPoint& point, const Material& material) {
  m_has_routine = material.model() != nullptr;
  if (m_has_routine) {
    m_frame = frame_about(point.n);
    m_routine = {*material.model(), m_frame.to_local(point.wo)};
    return;
  }
  m_density = wavelet::TreeDensity::of(material.lobe(point));
  m_frame = point.reflection.frame;
}

void Lobe::start(std::size_t count) {
  m_densities.assign(count, m_density);
  m_descents.assign(count, {});
}

void Lobe::sample(std::span<const Vec2> points, std::span<DirectionSample> out) {
  if (!m_has_routine)
    return sample_tree(points, out);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Vec3 local = m_routine.sample(points[i]);
    out[i] = {m_frame.to_outer(local), m_routine.pdf(local)};
  }
}

void Lobe::sample_tree(std::span<const Vec2> points, std::span<DirectionSample> out) {
  start(out.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    m_descents[i].u1 = points[i].x();
    m_descents[i].u2 = points[i].y();
  }
  wavelet::descend_tree(m_densities, m_descents);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {m_frame.to_outer(wavelet::square_to_sphere(wavelet::end_point(m_descents[i]))),
              m_descents[i].pdf / wavelet::sphere_area};
}

float Lobe::pdf(const Vec3& direction) const {
  if (m_has_routine)
    return m_routine.pdf(m_frame.to_local(direction));
  const Vec2 p = wavelet::sphere_to_square(m_frame.to_local(direction));
  wavelet::Descent d;
  wavelet::follow_tree(m_density, p.x(), p.y(), d);
  return d.pdf / wavelet::sphere_area;
}

void Lobe::pdfs(std::span<DirectionSample> samples) {
  if (!m_has_routine)
    return tree_pdfs(samples);
  for (DirectionSample& s : samples)
    s.pdf = pdf(s.direction);
}

void Lobe::tree_pdfs(std::span<DirectionSample> samples) {
  start(samples.size());
  m_points.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    m_points[i] = wavelet::sphere_to_square(m_frame.to_local(samples[i].direction));
  wavelet::follow_tree(m_densities, m_points, m_descents);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].pdf = m_descents[i].pdf / wavelet::sphere_area;
}

} // namespace haarlight::renderer
