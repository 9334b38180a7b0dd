#pragma once
// Products of trees as a tree, and integrals of products by factoring.

#include <wavelet/tree/map_set.h>
#include <wavelet/tree/tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {

struct MultiplyOptions {
  /// Coefficients of L2-normalised wavelets below this share of the product's mean (luminance) are
  /// dropped as the tree is made; 0 keeps all that are not zero.
  double tolerance = 0;
  CoefficientType coefficients = CoefficientType::Float;
  int levels = 0;   ///< of the product; at least the largest of the trees, which is the default (0)
  int channels = 1; ///< 3 = RGB even if all trees are grey
};

/// Π of the trees, colour by colour: exact but for rounding (of floats, or halves as asked for) and
/// dropping. RGB unless all are grey and `channels` is 1.
/// @param trees at least one
Tree multiply(std::span<const TreeView> trees, const MultiplyOptions& options = {});

/// ∫∫ Π over the unit square, per channel; times 4π for solid angle. Nothing is dropped.
/// @param trees at least one
Rgb product_integral(std::span<const TreeView> trees);

/// ⟨T1, T2⟩ = Σ_i T1_i T2_i over the orthonormal coefficients of two trees, per channel: by
/// Parseval ∫∫ T1·T2. With T1 and T2 the products of any split of n functions it is the integral of
/// all of them ("factoring" in the paper), and if one function varies, the other tree can be
/// reused.
Rgb inner_product(const TreeView& a, const TreeView& b);

/// All coefficients of one map, in the order of a complete tree: square 0 is the whole, quadrant q
/// of square i is square 4 i + 1 + q. An inner product then costs one multiply-add for each
/// coefficient of the sparse tree. Safe to share between threads.
class DenseCoefficients {
public:
  /// @param map of 2^levels pixels a side
  explicit DenseCoefficients(Map map);

  int levels() const { return m_levels; }
  /// Average over the whole.
  Rgb mean() const { return to_rgb(m_mean); }
  /// Differences of all squares in that order, times the squares' areas.
  std::span<const Details> details() const { return m_details; }

  /// ∫∫ F·T over the unit square for each tree T, per channel, by Parseval: colours times colours.
  /// @param trees of at most levels() levels
  /// @param out   as many as trees
  void inner_products(std::span<const TreeView> trees, std::span<Rgb> out) const;

private:
  int m_levels;
  Float4 m_mean;
  std::vector<Details> m_details; ///< times the square's area
};

} // namespace haarlight::wavelet
