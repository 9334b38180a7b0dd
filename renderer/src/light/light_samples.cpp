#include "light/light_samples.h"

#include <chrono>

namespace haarlight::renderer {

namespace {

std::size_t samples_of(const RenderOptions& options) {
  return static_cast<std::size_t>(options.spp);
}

} // namespace

LightSamples::LightSamples(const LoadedScene& scene, const RenderOptions& options,
                           const RenderFactories& factories)
    : m_scene(scene), m_options(options), m_sampler(factories.sampler->make(samples_of(options))),
      m_integrator(factories.integrator ? factories.integrator->make(samples_of(options))
                                        : nullptr) {}

void LightSamples::reset() {
  m_sampler->reset();
  if (m_integrator)
    m_integrator->reset();
}

void LightSamples::prepare(const PixelHit& seen, ShadingCost& cost) {
  const Light& light = m_scene.light();
  const Material& material = m_scene.material_of(seen.hit.object);
  m_seen = &seen;
  m_point = shading_point(light.to_light(seen.hit.normal), light.to_light(seen.wo));
  if (m_options.estimator == Estimator::Unbiased && m_scene.shapes().may_occlude(seen.hit.object))
    m_point.hit = &seen.hit;
  const auto start = std::chrono::steady_clock::now();
  m_sampler->prepare(m_point, material);
  if (m_integrator)
    m_integrator->prepare(m_point, material);
  cost.prepare_seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ++cost.points;
  cost.leaves += m_sampler->leaves();
}

std::optional<Rgb> LightSamples::unshadowed() const {
  if (!needs_unshadowed(m_options.estimator))
    return std::nullopt;
  return (m_integrator ? *m_integrator : *m_sampler).unshadowed().value_or(Rgb::Zero());
}

void LightSamples::sample(const Pass& pass) {
  m_directions.resize(pass.count);
  m_sampler->sample({m_options.points, hash_words(m_seen->pixel, m_options.seed), pass.first},
                    m_directions);
  m_candidates.clear();
  for (const DirectionSample& s : m_directions)
    m_candidates.push_back(s.direction);
  m_reflected.resize(pass.count);
  m_scene.material_of(m_seen->hit.object).evaluate(m_point, m_candidates, m_reflected);
  m_radiance.resize(pass.count);
  m_sampler->radiance(m_scene.light(), m_candidates, m_radiance);
  for (std::size_t i = 0; i < pass.count; ++i)
    m_reflected[i] *= m_radiance[i];
}

Rgb LightSamples::weight(std::size_t i) const {
  if (!(m_directions[i].pdf > 0) || !(m_reflected[i] > 0).any())
    return Rgb::Zero();
  return m_reflected[i] / m_directions[i].pdf;
}

bool LightSamples::visible(std::size_t i) const {
  if (!(m_directions[i].pdf > 0) || !(m_reflected[i] > 0).any())
    return false;
  return trace(i);
}

std::optional<bool> LightSamples::unoccluded(std::size_t i) const {
  const DirectionSample& s = m_directions[i];
  if (!(s.pdf > 0) || !(m_point.n.dot(s.direction) > 0))
    return std::nullopt;
  return trace(i);
}

SumVariance LightSamples::variance_of_sums(std::span<const Contribution> samples) {
  m_visible.clear();
  for (const Contribution& sample : samples)
    m_visible.push_back(sample.visible ? 1 : 0);
  SumVariance sum = renderer::variance_of_sums(samples);
  sum += m_sampler->shared_variance(m_visible);
  return sum;
}

bool LightSamples::trace(std::size_t i) const {
  const Vec3 w = m_scene.light().to_world(m_directions[i].direction);
  return !m_scene.shapes().occluded(leave(m_seen->hit, w));
}

} // namespace haarlight::renderer
