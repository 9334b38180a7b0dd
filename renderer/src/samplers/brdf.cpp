// The reflectance alone.

#include "samplers/lobe_sampling.h"
#include "samplers/sampler_factories.h"

namespace haarlight::renderer {
namespace {

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

std::unique_ptr<SamplerFactory> make_brdf_factory(const LoadedScene& /*scene*/,
                                                  const SamplerOptions& /*options*/) {
  return simple_factory<BrdfSampler>();
}

} // namespace haarlight::renderer
