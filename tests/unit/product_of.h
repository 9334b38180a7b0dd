#pragma once
// The product of two trees in one frame, for tests and benchmarks.

#include <wavelet/synchronous_product.h>

namespace haarlight::wavelet {

/// @param light its arrays must outlive the result
inline ProductTree product_of(const TreeView& light, const TreeView& reflectance,
                              const SquareSymmetry& symmetry = {}) {
  const TreeFactor first(light);
  const TreeFactor second(reflectance, symmetry);
  const Factor* const factors[] = {&first, &second};
  SynchronousProduct product;
  return product.build(factors);
}

} // namespace haarlight::wavelet
