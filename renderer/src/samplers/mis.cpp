// Multiple importance sampling: the first half of a pixel's samples follow the light, the rest the
// reflectance; every one counts with the mean density of both (balance heuristic, Veach and Guibas
// 1995).

#include "kinds.h"
#include "lobe_sampling.h"

namespace haarlight::renderer {
namespace {

class MisSampler : public Sampler {
public:
  explicit MisSampler(const Light& light) : m_light(light) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_lobe.prepare(point, material);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    const std::size_t from_light = light_share(out.size());
    sample_light(points, out.first(from_light), out.size());
    sample_lobe(points, out.subspan(from_light), out.size());
  }

  float pdf(const Vec3& direction, std::size_t count) const override {
    return mean_density(m_light.pdf(direction), m_lobe.pdf(direction), count);
  }

private:
  void sample_light(const PointSource& points, std::span<DirectionSample> out, std::size_t count) {
    m_points.resize(out.size());
    m_samples.resize(out.size());
    points.fill(0, m_points);
    m_light.sample(m_points, m_samples);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i].direction = m_samples[i].direction;
    m_lobe.pdfs(out);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i].pdf = mean_density(m_samples[i].pdf, out[i].pdf, count);
  }

  void sample_lobe(const PointSource& points, std::span<DirectionSample> out, std::size_t count) {
    m_points.resize(out.size());
    points.fill(1, m_points);
    m_lobe.sample(m_points, out);
    for (DirectionSample& s : out)
      s.pdf = mean_density(m_light.pdf(s.direction), s.pdf, count);
  }

  static std::size_t light_share(std::size_t count) { return (count + 1) / 2; }

  static float mean_density(float light, float lobe, std::size_t count) {
    const auto n = static_cast<float>(count);
    const auto n_light = static_cast<float>(light_share(count));
    return (n_light * light + (n - n_light) * lobe) / n;
  }

  const Light& m_light;
  Lobe m_lobe;
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

} // namespace

std::unique_ptr<SamplerFactory> make_mis_factory(const LoadedScene& scene,
                                                 const SamplerOptions& /*options*/) {
  return simple_factory<MisSampler>(std::cref(scene.light()));
}

} // namespace haarlight::renderer
