// The world-frame product: one light tree, and the reflectance's averages on the fly.
//
// Where something may be in the light's way, a share of the samples follows the light itself: what
// a square of the product that counts as hidden lets through then weighs no more than its
// reflectance.

#include "../visibility/hit_occlusion.h"
#include "kinds.h"
#include "product_options.h"
#include "product_tree_sampler.h"

#include <wavelet/adaptive_product.h>

#include <algorithm>
#include <cmath>

namespace haarlight::renderer {
namespace {

class ProductSampler : public ProductTreeSampler {
public:
  ProductSampler(const LoadedScene& scene, const ProductOptions& options)
      : m_light(scene.light()), m_builder(m_light.tree()), m_options(options),
        m_occlusion(scene.shapes(), m_light) {}

  void forget() override { m_follows = false; }

  void prepare(const ShadingPoint& point, const Material& material) override {
    const wavelet::RotatedReflectance reflectance = material.reflectance(point);
    const bool shadowed = point.hit != nullptr;
    if (shadowed)
      m_occlusion.turn_to(*point.hit);
    const wavelet::AdaptiveOptions& options = shadowed ? m_options.shadowed : m_options.open;
    const wavelet::Occlusion* occlusion = shadowed ? &m_occlusion : nullptr;
    m_product = m_follows ? &m_builder.follow(reflectance, options, occlusion)
                          : &m_builder.build(reflectance, options, occlusion);
    m_follows = true;
    m_mixes = shadowed && !m_product->empty();
  }

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

private:
  static std::size_t light_count(std::size_t count) { return count / 4; }

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
  wavelet::AdaptiveProduct m_builder;
  ProductOptions m_options;
  detail::HitOcclusion m_occlusion;
  bool m_follows = false;
  bool m_mixes = false;
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

/// Where shadows add about ten times the variance that stays in the open, bounds are so much
/// higher: they go by its square root.
constexpr float shadow_ratio = 3;

class ProductFactory : public SamplerFactory {
public:
  ProductFactory(const LoadedScene& scene, const SamplerOptions& options)
      : m_scene(scene), m_options(options) {}

  std::unique_ptr<Sampler> make(std::size_t count) const override {
    return std::make_unique<ProductSampler>(m_scene,
                                            product_options(m_options, count, shadow_ratio));
  }

private:
  const LoadedScene& m_scene;
  SamplerOptions m_options;
};

} // namespace

float default_variance_bound(std::size_t count) {
  return std::clamp(0.12F / std::sqrt(static_cast<float>(count)), 0.002F, 0.1F);
}

std::unique_ptr<SamplerFactory> make_product_factory(const LoadedScene& scene,
                                                     const SamplerOptions& options) {
  return std::make_unique<ProductFactory>(scene, options);
}

} // namespace haarlight::renderer
