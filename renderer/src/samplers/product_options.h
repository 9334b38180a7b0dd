#pragma once
// How far samplers refine products of one light tree and the reflectance's averages.

#include <renderer/samplers/sampler.h>

namespace haarlight::renderer {

struct ProductOptions {
  wavelet::AdaptiveOptions open;
  wavelet::AdaptiveOptions shadowed; ///< where something may be in the way
};

/// @param count as SamplerFactory::make() is told
/// @param shadow_ratio of the default bound where something may be in the way to that in the open
inline ProductOptions product_options(const SamplerOptions& options, std::size_t count,
                                      float shadow_ratio) {
  ProductOptions result = {options.product, options.product};
  if (options.product.variance_bound == 0) {
    result.open.variance_bound = default_variance_bound(count);
    result.shadowed.variance_bound = shadow_ratio * result.open.variance_bound;
  }
  return result;
}

} // namespace haarlight::renderer
