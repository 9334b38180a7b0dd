#include "samplers/basic_samplers.h"

#include "samplers/sampler_factories.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

TechniqueSplit mis_split(std::size_t count) {
  return count == 1 ? TechniqueSplit{1, 2} : TechniqueSplit{(count + 1) / 2, count};
}

class BrdfSampler : public Sampler {
public:
  void prepare(const ShadingPoint& point, const Material& material) override {
    m_lobe.prepare(point, material);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(1, m_points);
    m_lobe.sample(m_points, out);
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_lobe.pdf(direction);
  }

private:
  Lobe m_lobe;
  std::vector<Vec2> m_points;
};

} // namespace

void LightSampler::sample(const PointSource& points, std::span<DirectionSample> out) {
  m_points.resize(out.size());
  m_samples.resize(out.size());
  points.fill(0, m_points);
  m_light.sample(m_points, m_samples);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {m_samples[i].direction, m_samples[i].pdf};
}

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

void Lobe::sample(std::span<const Vec2> points, std::span<DirectionSample> out) {
  if (m_has_routine) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec3 local = m_routine.sample(points[i]);
      out[i] = {m_frame.to_outer(local), m_routine.pdf(local)};
    }
    return;
  }
  m_densities.assign(out.size(), m_density);
  m_descents.assign(out.size(), {});
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
  if (m_has_routine) {
    for (DirectionSample& s : samples)
      s.pdf = pdf(s.direction);
    return;
  }
  m_densities.assign(samples.size(), m_density);
  m_descents.assign(samples.size(), {});
  m_points.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    m_points[i] = wavelet::sphere_to_square(m_frame.to_local(samples[i].direction));
  wavelet::follow_tree(m_densities, m_points, m_descents);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].pdf = m_descents[i].pdf / wavelet::sphere_area;
}

DirectionSample MisSampler::combined(const Vec3& direction, Technique technique, float light,
                                     float lobe) const {
  const float own = technique == Technique::First ? light : lobe;
  const float other = technique == Technique::First ? lobe : light;
  float pdf = own + other;
  if (m_heuristic == Heuristic::Power) // the square of a sharp lobe's density must stay finite
    pdf = own > 0 ? std::min(own + other * (other / own), 1e30F) : 0.0F;
  const float sum = light + lobe;
  if (!(sum > 0))
    return {direction, pdf, technique};
  const float balance = light / sum;
  const float power = balance * balance / (balance * balance + (1 - balance) * (1 - balance));
  return {
      direction, pdf, technique, {balance, m_heuristic == Heuristic::Balance ? balance : power}};
}

void MisSampler::sample(const PointSource& points, std::span<DirectionSample> out) {
  const TechniqueSplit split = mis_split(out.size());
  const std::size_t light_count = split.count(points, out.size());
  const float light_share = split.fraction();
  const std::span<DirectionSample> from_light = out.first(light_count);
  const std::span<DirectionSample> from_lobe = out.subspan(light_count);

  m_light.sample(points, from_light);
  m_light_pdfs.clear();
  for (const DirectionSample& s : from_light)
    m_light_pdfs.push_back(s.pdf);
  m_lobe.pdfs(from_light);
  for (std::size_t i = 0; i < light_count; ++i)
    from_light[i] =
        combined(from_light[i].direction, Technique::First, light_share * m_light_pdfs[i],
                 (1.0F - light_share) * from_light[i].pdf);

  m_points.resize(from_lobe.size());
  points.fill(1, m_points);
  m_lobe.sample(m_points, from_lobe);
  for (DirectionSample& s : from_lobe)
    s = combined(s.direction, Technique::Second, light_share * m_light.pdf(s.direction),
                 (1.0F - light_share) * s.pdf);
}

float MisSampler::pdf(const Vec3& direction, std::size_t count) const {
  const float light_share = mis_split(count).fraction();
  return light_share * m_light.pdf(direction) + (1.0F - light_share) * m_lobe.pdf(direction);
}

std::unique_ptr<SamplerFactory> make_light_factory(const LoadedScene& scene,
                                                   const SamplerOptions& /*options*/) {
  return simple_factory<LightSampler>(std::cref(scene.light()));
}

std::unique_ptr<SamplerFactory> make_brdf_factory(const LoadedScene& /*scene*/,
                                                  const SamplerOptions& /*options*/) {
  return simple_factory<BrdfSampler>();
}

std::unique_ptr<SamplerFactory> make_mis_factory(const LoadedScene& scene,
                                                 const SamplerOptions& /*options*/) {
  return simple_factory<MisSampler>(std::cref(scene.light()), Heuristic::Balance);
}

std::unique_ptr<SamplerFactory> make_mis_power_factory(const LoadedScene& scene,
                                                       const SamplerOptions& /*options*/) {
  return simple_factory<MisSampler>(std::cref(scene.light()), Heuristic::Power);
}

} // namespace haarlight::renderer
