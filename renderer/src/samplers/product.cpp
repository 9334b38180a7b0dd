// The world-frame product: one light tree, and the reflectance's averages on the fly.

#include "kinds.h"
#include "product_tree_sampler.h"

#include <wavelet/adaptive_product.h>

namespace haarlight::renderer {
namespace {

class ProductSampler : public ProductTreeSampler {
public:
  ProductSampler(const Light& light, const wavelet::AdaptiveOptions& options)
      : m_builder(light.tree()), m_options(options) {}

  void forget() override { m_follows = false; }

  void prepare(const ShadingPoint& point, const Material& material) override {
    const wavelet::RotatedReflectance reflectance = material.reflectance(point);
    m_product = m_follows ? &m_builder.follow(reflectance, m_options, point.occlusion)
                          : &m_builder.build(reflectance, m_options, point.occlusion);
    m_follows = true;
  }

private:
  wavelet::AdaptiveProduct m_builder;
  wavelet::AdaptiveOptions m_options;
  bool m_follows = false;
};

} // namespace

std::unique_ptr<SamplerFactory> make_product_factory(const LoadedScene& scene,
                                                     const SamplerOptions& options) {
  return simple_factory<ProductSampler>(std::cref(scene.light()), options.product);
}

} // namespace haarlight::renderer
