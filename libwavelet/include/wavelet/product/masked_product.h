#pragma once
// A product of light and reflectance times any number of masks, such as visibilities: the integral
// of n + 2 functions, of which the product holds two.

#include <wavelet/product/product_tree.h>

#include <array>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// A leaf of a product with light left on it.
struct MaskedLeaf {
  Float4 left = {};           ///< average over its square of light times masks, lanes R, G, B, *
  std::uint16_t x = 0, y = 0; ///< in squares of its level
  std::uint8_t level = 0;

private:
  friend class MaskedProduct;
  Float4 m_light = {}; ///< average of the light alone
  std::uint32_t m_node = no_node;
  float m_scale = 1;              ///< product of the masks that are constant over the square
  std::uint32_t m_first_mask = 0; ///< of those that are not
  std::uint32_t m_mask_count = 0;
};

/// Walks a product and the trees of masks side by side. Below a leaf, where the reflectance counts
/// as constant, it goes on through the light's tree and the masks' as far as two of them have
/// detail: exact for all of these. Reused from product to product, it allocates nothing.
class MaskedProduct {
public:
  /// The leaves that reflect something and that something is left of; valid until the next call.
  /// @param product adaptive, whose leaves know their places; must outlive the leaves, and so must
  ///                the masks
  /// @param masks   of a single channel
  std::span<const MaskedLeaf> build(const ProductTree& product, std::span<const TreeView> masks);

  /// Appends the quadrants of a leaf, of this product, that something is left of.
  /// @param leaf is copied: it may be one of `out`
  void split(MaskedLeaf leaf, std::vector<MaskedLeaf>& out);

private:
  /// A mask that varies over the square at hand.
  struct Mask {
    const TreeView* tree = nullptr;
    std::uint32_t node = no_node;
    float mean = 0;
  };
  /// Its quadrants.
  struct MaskQuadrants {
    const TreeView* tree = nullptr;
    std::array<std::uint32_t, 4> nodes = {};
    Float4 means = {};
  };
  /// Masks from `first` on vary; `scale` is the product of the others.
  struct Masks {
    std::size_t first = 0;
    float scale = 1;
  };

  void visit(std::int32_t child, Masks masks);
  Float4 light_below(Float4 mean, std::uint32_t node, Masks masks);
  void add_leaf(MaskedLeaf leaf, Masks masks, std::vector<MaskedLeaf>& out);
  void split_masks(Masks masks);
  Masks quadrant(unsigned q, std::size_t splits, float scale);

  const ProductTree* m_product = nullptr;
  const TreeView* m_light = nullptr;
  std::vector<Mask> m_masks; ///< a stack, like the next
  std::vector<MaskQuadrants> m_splits;
  std::vector<MaskedLeaf> m_leaves;
  std::vector<Mask> m_leaf_masks; ///< those that vary over leaves
};

} // namespace haarlight::wavelet
