#pragma once
// The inner loops of a synchronous product: over many squares, four quadrants at a time.

#include <wavelet/product/synchronous_product.h>

namespace haarlight::wavelet::detail {

/// A stored tree's quadrants, as Factor::split() wants them.
void split_tree(const TreeView& view, const TreeTurn& turn, const FactorSquares& squares,
                const FactorQuadrants& out);

/// Squares whose quadrants every factor has told, and where goes what they become. Arrays go by
/// product node.
struct SplitSquares {
  std::span<const ProductFactor> factors;
  std::size_t begin = 0; ///< the squares' product nodes
  std::size_t end = 0;
  bool may_split = true;      ///< quadrants may become nodes
  std::size_t node_count = 0; ///< grows by the quadrants that become nodes
  ProductNode* nodes = nullptr;
  std::int32_t* parent_slots = nullptr; ///< room for four more than all quadrants
  Float4 leaf_sum = {};                 ///< grows by the leaves' products
};

/// Makes every quadrant a node or a leaf, and weighs the leaves.
void finish(SplitSquares& squares);

} // namespace haarlight::wavelet::detail
