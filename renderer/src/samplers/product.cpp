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

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_product = &m_builder.build(material.reflectance(point), m_options);
  }

private:
  wavelet::AdaptiveProduct m_builder;
  wavelet::AdaptiveOptions m_options;
};

} // namespace

std::unique_ptr<SamplerFactory> make_product_factory(const LoadedScene& scene,
                                                     const SamplerOptions& options) {
  return simple_factory<ProductSampler>(std::cref(scene.light()), options.product);
}

} // namespace haarlight::renderer
