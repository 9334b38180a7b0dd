// The light alone: pixels of the probe by cdf inversion.

#include "samplers/sampler_factories.h"

namespace haarlight::renderer {
namespace {

class LightSampler : public Sampler {
public:
  explicit LightSampler(const Light& light) : m_light(light) {}

  void prepare(const ShadingPoint& /*point*/, const Material& /*material*/) override {}

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(0, m_points);
    m_samples.resize(out.size());
    m_light.sample(m_points, m_samples);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {m_samples[i].direction, m_samples[i].pdf};
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_light.pdf(direction);
  }

private:
  const Light& m_light;
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

} // namespace

std::unique_ptr<SamplerFactory> make_light_factory(const LoadedScene& scene,
                                                   const SamplerOptions& /*options*/) {
  return simple_factory<LightSampler>(std::cref(scene.light()));
}

} // namespace haarlight::renderer
