// The world-frame product: one light tree, and the reflectance's averages on the fly.
//
// Where something may be in the light's way, a share of the samples follows the light itself: what
// a square of the product that counts as hidden lets through then weighs no more than its
// reflectance.

#include "samplers/kinds.h"
#include "samplers/light_mixture.h"
#include "samplers/product_options.h"
#include "visibility/hit_occlusion.h"

#include <wavelet/product/adaptive_product.h>

#include <algorithm>
#include <cmath>

namespace haarlight::renderer {
namespace {

/// A quarter of the samples follows the light where something may be in its way.
constexpr std::size_t samples_each_of_light = 4;

class ProductSampler : public LightMixture {
public:
  ProductSampler(const LoadedScene& scene, const ProductOptions& options)
      : LightMixture(scene.light(), samples_each_of_light), m_builder(scene.light().tree()),
        m_options(options), m_visibility(scene.shapes(), scene.light()) {}

  void forget() override { m_follows = false; }

  void prepare(const ShadingPoint& point, const Material& material) override {
    const wavelet::RotatedReflectance reflectance = material.reflectance(point);
    const bool shadowed = point.hit != nullptr;
    if (shadowed)
      m_visibility.set_shading_point(*point.hit);
    const wavelet::AdaptiveOptions& options = shadowed ? m_options.shadowed : m_options.open;
    wavelet::SquareVisibility* visibility = shadowed ? &m_visibility : nullptr;
    m_product = m_follows ? &m_builder.build_or_reuse(reflectance, options, visibility)
                          : &m_builder.build(reflectance, options, visibility);
    m_follows = true;
    m_mixes = shadowed && !m_product->empty();
  }

private:
  wavelet::AdaptiveProduct m_builder;
  ProductOptions m_options;
  detail::HitOcclusion m_visibility;
  bool m_follows = false;
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
