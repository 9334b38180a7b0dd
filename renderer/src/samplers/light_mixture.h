#pragma once
// Products in the light's frame, mixed with samples of the light alone: where the product's density
// is too low, behind an occluder or at the foot of a lobe, weights then stay bounded.

#include "samplers/product_tree_sampler.h"
#include "samplers/technique_split.h"

namespace haarlight::renderer {

/// prepare() of the derived sampler sets m_product and m_mixes.
class LightMixture : public ProductTreeSampler {
public:
  /// @param each of so many samples one follows the light where m_mixes, at least 4
  LightMixture(const Light& light, std::size_t each) : m_light(light), m_each(each) {}

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    if (!m_mixes)
      return ProductTreeSampler::sample(points, out);
    const TechniqueSplit split = split_of(out.size());
    const std::size_t of_light = split.count(points, out.size());
    const float share = split.fraction();
    const std::span<DirectionSample> own = out.first(out.size() - of_light);
    ProductTreeSampler::sample(points, own);
    for (DirectionSample& s : own)
      s = mixed(s.direction, Technique::First, (1 - share) * s.pdf,
                share * m_light.pdf(s.direction));
    sample_light(points, share, out.last(of_light));
  }

  float pdf(const Vec3& direction, std::size_t count) const override {
    const float own = ProductTreeSampler::pdf(direction, count);
    if (!m_mixes)
      return own;
    const float share = split_of(count).fraction();
    return (1 - share) * own + share * m_light.pdf(direction);
  }

protected:
  bool m_mixes = false;

private:
  /// Two samples at least, from which their variance is estimated, but no more than a quarter; one
  /// of two or three.
  TechniqueSplit split_of(std::size_t count) const {
    if (count == 1)
      return {1, 4};
    const std::size_t guard = std::clamp<std::size_t>(count / 4, 1, 2);
    return {std::max(count / m_each, guard), count};
  }

  void sample_light(const PointSource& points, float share, std::span<DirectionSample> out) {
    m_points.resize(out.size());
    m_samples.resize(out.size());
    points.fill(0, m_points);
    m_light.sample(m_points, m_samples);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec3& direction = m_samples[i].direction;
      out[i] = mixed(direction, Technique::Second,
                     (1 - share) * ProductTreeSampler::pdf(direction, 1), share * m_samples[i].pdf);
    }
  }

  /// A sample of the product (First) or the light (Second), with the share of either in its
  /// density.
  static DirectionSample mixed(const Vec3& direction, Technique technique, float product,
                               float light) {
    const float pdf = product + light;
    const float first = pdf > 0 ? product / pdf : 1.0F;
    return {direction, pdf, technique, {first, first}};
  }

  const Light& m_light;
  std::size_t m_each;
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

} // namespace haarlight::renderer
