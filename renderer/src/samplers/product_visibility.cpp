// The product of light, reflectance and the visibilities of all objects: the world-frame product
// whose squares, from the coarsest on, count for what geometry tells is seen of them, so that what
// is hidden costs nothing and shadow edges are followed to fine squares.

#include "samplers/kinds.h"
#include "samplers/light_mixture.h"
#include "samplers/product_options.h"
#include "visibility/seen_squares.h"

#include <wavelet/product/adaptive_product.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

/// One in so many samples follows the light where something may be in its way.
constexpr std::size_t samples_each_of_light = 16;

class ProductVisibilitySampler : public LightMixture {
public:
  ProductVisibilitySampler(const LoadedScene& scene, const ProductOptions& options)
      : LightMixture(scene.light(), samples_each_of_light), m_builder(scene.light().tree()),
        m_options(options), m_visibility(scene.shapes(), scene.light()) {}

  void forget() override { m_follows = false; }

  void prepare(const ShadingPoint& point, const Material& material) override {
    const wavelet::RotatedReflectance reflectance = material.reflectance(point);
    if (point.hit != nullptr) {
      m_visibility.set_shading_point(*point.hit);
      m_product = &m_builder.build(reflectance, m_options.shadowed, &m_visibility,
                                   wavelet::VisibilityTest::Squares);
    } else {
      m_product = m_follows ? &m_builder.build_or_reuse(reflectance, m_options.open)
                            : &m_builder.build(reflectance, m_options.open);
    }
    m_follows = true;
    m_mixes = point.hit != nullptr && !m_product->empty();
  }

private:
  wavelet::AdaptiveProduct m_builder;
  ProductOptions m_options;
  detail::SeenSquares m_visibility;
  bool m_follows = false;
};

/// Of the default bound where something may be in the way to that in the open. Leaves cost several
/// times as much there, as what is seen of them has to be found.
constexpr float shadow_ratio = 6;

/// Leaves there at most for each sample, so that intricate shadows do not cost many times what the
/// samples do.
constexpr std::size_t leaves_per_sample = 25;

/// Fewer samples than this do not lower the number of leaves: a narrow lobe (chrome under grace,
/// with shadows) that 100 leaves do not resolve has a relative error of 5 at 4 samples.
constexpr std::size_t least_samples_for_leaves = 16;

class ProductVisibilityFactory : public SamplerFactory {
public:
  ProductVisibilityFactory(const LoadedScene& scene, const SamplerOptions& options)
      : m_scene(scene), m_options(options) {}

  std::unique_ptr<Sampler> make(std::size_t count) const override {
    ProductOptions options = product_options(m_options, count, shadow_ratio);
    int& most = options.shadowed.max_leaves;
    const std::size_t affordable = leaves_per_sample * std::max(count, least_samples_for_leaves);
    most = static_cast<int>(std::min(static_cast<std::size_t>(most), affordable));
    return std::make_unique<ProductVisibilitySampler>(m_scene, options);
  }

private:
  const LoadedScene& m_scene;
  SamplerOptions m_options;
};

} // namespace

std::unique_ptr<SamplerFactory> make_product_visibility_factory(const LoadedScene& scene,
                                                                const SamplerOptions& options) {
  return std::make_unique<ProductVisibilityFactory>(scene, options);
}

} // namespace haarlight::renderer
