#pragma once
// The product of trees as a tree, and integrals of products by factoring.

#include <wavelet/tree/tree.h>

#include <span>

namespace haarlight::wavelet {

struct MultiplyOptions {
  /// Coefficients of L2-normalised wavelets below this share of the product's mean (luminance) are
  /// dropped as the tree is made; 0 keeps all that are not zero.
  double tolerance = 0;
  CoefficientType coefficients = CoefficientType::Float;
  int levels = 0;   ///< of the product; at least what the trees have, which 0 stands for
  int channels = 1; ///< 3 = RGB even if all trees are grey
};

/// Π of the trees, colour by colour: exact but for rounding (of floats, or halves as asked for) and
/// what is dropped. RGB unless all are grey and nothing else is asked for.
/// @param trees at least one
Tree multiply(std::span<const TreeView> trees, const MultiplyOptions& options = {});

/// ∫∫ Π over the unit square, per channel; times 4π for solid angle. Nothing is dropped.
/// @param trees at least one
Rgb product_integral(std::span<const TreeView> trees);

/// ⟨T1, T2⟩ = Σ_i T1_i T2_i over the orthonormal coefficients of two trees, per channel: by
/// Parseval ∫∫ T1·T2. With T1 and T2 the products of any split of n functions it is the integral of
/// all of them ("factoring" in the paper), and if one function varies the other tree is kept.
Rgb inner_product(const TreeView& a, const TreeView& b);

} // namespace haarlight::wavelet
