// Multiple importance sampling: the first half of a pixel's samples follow the light, the rest the
// reflectance; every one counts with the mean density of both (balance heuristic, Veach and Guibas
// 1995).

#include "lobe_sampling.h"
#include "sampler_kinds.h"

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
    m_points.resize(out.size());
    points.fill(0, std::span(m_points).first(from_light));
    points.fill(1, std::span(m_points).subspan(from_light));
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (i < from_light) {
        const probe::LightSample s = m_light.sample(m_points[i]);
        out[i] = {s.direction, mean_density(s.pdf, m_lobe.pdf(s.direction), out.size())};
      } else {
        const DirectionSample s = m_lobe.sample(m_points[i]);
        out[i] = {s.direction, mean_density(m_light.pdf(s.direction), s.pdf, out.size())};
      }
    }
  }

  float pdf(const Vec3& direction, std::size_t count) const override {
    return mean_density(m_light.pdf(direction), m_lobe.pdf(direction), count);
  }

private:
  static std::size_t light_share(std::size_t count) { return (count + 1) / 2; }

  static float mean_density(float light, float lobe, std::size_t count) {
    const auto n = static_cast<float>(count);
    const auto n_light = static_cast<float>(light_share(count));
    return (n_light * light + (n - n_light) * lobe) / n;
  }

  const Light& m_light;
  Lobe m_lobe;
  std::vector<Vec2> m_points;
};

} // namespace

std::unique_ptr<Sampler> make_mis_sampler(const Light& light) {
  return std::make_unique<MisSampler>(light);
}

} // namespace haarlight::renderer
