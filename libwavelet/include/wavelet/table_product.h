#pragma once
// The exact product of two stored trees in one frame.

#include <wavelet/product_tree.h>
#include <wavelet/symmetry.h>

namespace haarlight::wavelet {

/// Walks both trees at once: where one tree ends its factor is constant, and the product is the
/// other's. Gives the averages that OPPRODUCT of the paper (Table 4) finds through coefficient
/// sums.
class TableProduct {
public:
  /// @param light       its arrays must outlive the result
  /// @param reflectance seen through `symmetry`
  static ProductTree build(const TreeView& light, const TreeView& reflectance,
                           const SquareSymmetry& symmetry);

private:
  struct Builder;
};

} // namespace haarlight::wavelet
