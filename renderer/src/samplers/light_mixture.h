#pragma once
// Products in the light's frame, a share of whose samples may follow the light itself: what the
// product takes for hidden, or for the foot of a lobe, then weighs no more than its reflectance.

#include "product_tree_sampler.h"

namespace haarlight::renderer {

/// prepare() of the derived sampler sets m_product and m_mixes.
class LightMixture : public ProductTreeSampler {
public:
  /// @param each one of so many samples follows the light, where m_mixes
  LightMixture(const Light& light, std::size_t each) : m_light(light), m_each(each) {}

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    const std::size_t of_light = m_mixes ? light_count(out.size()) : 0;
    const std::span<DirectionSample> own = out.first(out.size() - of_light);
    ProductTreeSampler::sample(points, own);
    if (of_light == 0)
      return;
    const float share = static_cast<float>(of_light) / static_cast<float>(out.size());
    for (DirectionSample& s : own)
      s.pdf = (1 - share) * s.pdf + share * m_light.pdf(s.direction);
    sample_light(points, share, out.last(of_light));
  }

  float pdf(const Vec3& direction, std::size_t count) const override {
    const float own = ProductTreeSampler::pdf(direction, count);
    if (!m_mixes)
      return own;
    const float share = static_cast<float>(light_count(count)) / static_cast<float>(count);
    return (1 - share) * own + share * m_light.pdf(direction);
  }

protected:
  bool m_mixes = false;

private:
  std::size_t light_count(std::size_t count) const { return count / m_each; }

  void sample_light(const PointSource& points, float share, std::span<DirectionSample> out) {
    m_points.resize(out.size());
    m_samples.resize(out.size());
    points.fill(0, m_points);
    m_light.sample(m_points, m_samples);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec3& direction = m_samples[i].direction;
      out[i] = {direction,
                (1 - share) * ProductTreeSampler::pdf(direction, 1) + share * m_samples[i].pdf};
    }
  }

  const Light& m_light;
  std::size_t m_each;
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

} // namespace haarlight::renderer
