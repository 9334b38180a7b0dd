#pragma once
// Products for tests: of two trees in one frame, and whether their samples follow their pdf.

#include "chi_square.h"

#include <wavelet/product/synchronous_product.h>

#include <random>

namespace haarlight::wavelet {

/// @param light its arrays must outlive the result
inline ProductTree product_of(const TreeView& light, const TreeView& reflectance,
                              const SquareSymmetry& symmetry = {}) {
  const TreeFactor factors[] = {TreeFactor(light), TreeFactor(reflectance, symmetry)};
  SynchronousProduct product;
  return product.build(factors);
}

/// Of 200000 samples, over 32 × 32 cells. @param taps points a side that the pdf is summed at in
/// each
inline ChiSquareResult chi_square_of(const ProductTree& product, int taps) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  return chi_square(
      200000, 32, taps,
      [&](int) { return end_point(product.sample(uniform(generator), uniform(generator))); },
      [&](Vec2 p) { return static_cast<double>(product.pdf(p.x(), p.y())); });
}

} // namespace haarlight::wavelet
