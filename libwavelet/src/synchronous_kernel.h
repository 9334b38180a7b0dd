#pragma once
// The inner loops of a synchronous product: over the squares of a run, four quadrants at a time.

#include <wavelet/synchronous_product.h>

#include <array>

namespace haarlight::wavelet::detail {

/// Squares that are split together: few enough that their quadrants stay in the cache.
inline constexpr std::size_t square_run = 32;

/// A stored tree's quadrants, as Factor::split() wants them.
void split_tree(const TreeView& view, const TreeTurn& turn, const FactorSquares& squares,
                const FactorQuadrants& out);

/// Squares of a run whose quadrants every factor has given, and where what they become goes.
struct ProductRun {
  std::span<const ProductFactor> factors;
  std::size_t squares = 0;
  std::int32_t level = 0;      ///< of the quadrants
  bool splits = false;         ///< quadrants may be split further
  std::int32_t first_node = 0; ///< product node of the first square
  std::int32_t next_node = 0;  ///< that the first quadrant to be split gets
  std::int32_t next_leaf = 0;
  ProductNode* nodes = nullptr;  ///< of the squares
  ProductLeaf* leaves = nullptr; ///< room for all quadrants

  // What comes of them: quadrants 4 × square + q, by what they become.
  std::size_t split_count = 0;
  std::size_t leaf_count = 0;
  std::array<std::int32_t, 4 * square_run> split_quadrants;
  std::array<std::int32_t, 4 * square_run> leaf_quadrants;
  std::array<std::int32_t, 4 * square_run> rest;       ///< the factor that may have detail
  std::array<std::uint32_t, 4 * square_run> rest_node; ///< and its handle
  Float4 leaf_sum = {};                                ///< of the leaves' products
};

/// Makes a leaf of every quadrant that is not to be split, and tells the others.
void finish_run(ProductRun& run);

} // namespace haarlight::wavelet::detail
