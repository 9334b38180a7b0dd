#include "path/path_vertex.h"

namespace haarlight::renderer {
namespace {

/// Dimensions of a vertex's points.
enum Dimension : std::uint32_t { OfLight, OfLobe, OfEmitter, OfChoice };

} // namespace

void PathVertex::set_hit(const Hit& hit, const Vec3& wo, const VertexCounts& counts) {
  const Light& light = m_scene.light();
  m_counts = counts;
  m_hit = hit;
  m_point = shading_point(light.to_light(hit.normal), light.to_light(wo));
  m_material = &m_scene.material_of(hit.object);
  m_lobe.prepare(m_point, *m_material);
}

/// Sets m_reflected to f_r cos of the samples' directions.
void PathVertex::evaluate(std::span<const DirectionSample> samples) {
  m_directions.clear();
  for (const DirectionSample& s : samples)
    m_directions.push_back(s.direction);
  m_reflected.resize(samples.size());
  m_material->evaluate(m_point, m_directions, m_reflected);
}

void PathVertex::add_light(const VertexPoints& points, std::span<Rgb> sums) {
  const Light& light = m_scene.light();
  const std::size_t each = static_cast<std::size_t>(m_counts.lights);
  const std::size_t count = each * sums.size();
  m_points.resize(count);
  points.fill(OfLight, m_counts.lights, m_points);
  m_lights.resize(count);
  light.sample(m_points, m_lights);
  m_samples.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    m_samples[i].direction = m_lights[i].direction;
  evaluate(m_samples);
  m_lobe.pdfs(m_samples);
  m_radiance.resize(count);
  light.radiance(m_directions, m_radiance);
  for (std::size_t i = 0; i < count; ++i) {
    const Rgb reflected = m_reflected[i] * m_radiance[i];
    if (!(m_lights[i].pdf > 0) || !(reflected > 0).any())
      continue;
    if (!m_scene.shapes().occluded(leave(m_hit, light.to_world(m_directions[i]))))
      sums[i / each] +=
          reflected / (lights() * m_lights[i].pdf + bsdf_samples() * m_samples[i].pdf);
  }
}

void PathVertex::add_emitters(const VertexPoints& points, std::span<Rgb> sums) {
  if (m_emitters.empty())
    return;
  const std::size_t each = static_cast<std::size_t>(m_counts.lights);
  m_points.resize(each * sums.size());
  points.fill(OfEmitter, m_counts.lights, m_points);
  m_choices.resize(m_points.size());
  points.fill(OfChoice, m_counts.lights, m_choices);
  for (std::size_t i = 0; i < m_points.size(); ++i)
    if (const auto to = m_emitters.sample(m_hit, m_choices[i].x(), m_points[i]))
      sums[i / each] += emitter_sample(*to);
}

Rgb PathVertex::emitter_sample(const EmitterDirection& to) const {
  Hit hit;
  if (!(m_hit.normal.dot(to.direction) > 0) ||
      !m_scene.shapes().intersect(leave(m_hit, to.direction), hit) || hit.object != to.object)
    return Rgb::Zero();
  const float pdf = m_emitters.pdf(m_hit, to.direction, hit);
  if (!(pdf > 0))
    return Rgb::Zero();
  const Vec3 w = m_scene.light().to_light(to.direction);
  return m_material->evaluate(m_point, w) * m_scene.material_of(hit.object).emission() /
         (lights() * pdf + bsdf_samples() * m_lobe.pdf(w));
}

void PathVertex::sample_bsdf(const VertexPoints& points, std::span<BsdfSample> out) {
  m_points.resize(out.size());
  points.fill(OfLobe, m_counts.bsdf_samples, m_points);
  m_samples.resize(out.size());
  m_lobe.sample(m_points, m_samples);
  evaluate(m_samples);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const DirectionSample& s = m_samples[i];
    const Rgb weight = s.pdf > 0 ? Rgb(m_reflected[i] / s.pdf) : Rgb(Rgb::Zero());
    out[i] = {m_scene.light().to_world(s.direction), weight, s.pdf};
  }
}

PathStep PathVertex::look(const BsdfSample& bsdf_sample) const {
  Hit hit;
  if (!m_scene.shapes().intersect(leave(m_hit, bsdf_sample.direction), hit))
    return {m_counts.shares_distant ? escaped(bsdf_sample) : Rgb(Rgb::Zero()), std::nullopt};
  PathStep found{met(bsdf_sample, hit), hit};
  if (hit.normal.dot(bsdf_sample.direction) > 0)
    found.hit->normal = -hit.normal;
  return found;
}

/// The share of the distant light seen along a bsdf_sample that add_light() leaves to it.
Rgb PathVertex::escaped(const BsdfSample& bsdf_sample) const {
  const Light& light = m_scene.light();
  const Vec3 w = light.to_light(bsdf_sample.direction);
  return light.radiance(w) * balance(bsdf_samples() * bsdf_sample.pdf, lights() * light.pdf(w));
}

/// The share of what `hit` emits that add_emitters() leaves to a bsdf_sample.
Rgb PathVertex::met(const BsdfSample& bsdf_sample, const Hit& hit) const {
  const Rgb& emission = m_scene.material_of(hit.object).emission();
  if (m_emitters.empty() || !(emission > 0).any())
    return emission;
  const float pdf = m_emitters.pdf(m_hit, bsdf_sample.direction, hit);
  return emission * balance(bsdf_samples() * bsdf_sample.pdf, lights() * pdf);
}

} // namespace haarlight::renderer
