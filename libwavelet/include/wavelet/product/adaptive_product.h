#pragma once
// Products of a light and a reflectance at one shading point after another, and their integrals
// with visibilities.

#include <wavelet/product/product_tree.h>
#include <wavelet/square/square.h>
#include <wavelet/tree/pyramid.h>

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// The reflectance at a shading point, as seen from the light's frame.
struct RotatedReflectance {
  const Pyramid* pyramid = nullptr;
  int theta_index0 = 0; ///< two neighbouring entries (θ_r) …
  int theta_index1 = 0;
  float blend = 0;            ///< … and the weight of the second
  ReflectionFrame reflection; ///< the pyramid's local frame, in the light's axes
};

struct AdaptiveOptions {
  /// Refine until the estimated relative variance that is left is below this.
  float variance_bound = 0.03F;
  int max_leaves = 4096;
  /// Estimated relative variance that build_or_reuse() may add by reusing a product.
  float reuse_variance_bound = 0.01F;
};

/// The visibility of one square.
struct SquareView {
  float seen = 1; ///< visible fraction in [0, 1], estimated; what lies below the horizon does not
                  ///< count
  std::uint64_t occluders = ~std::uint64_t{0}; ///< possible occluders, as bits with a meaning known
                                               ///< to the SquareVisibility only; 0 = none
};

/// Visibility query for directions of the light at a shading point.
class SquareVisibility {
public:
  virtual ~SquareVisibility() = default;

  /// Sets `views` to the visibility of as many squares of the light's frame, of level ≥ 3.
  /// @param views on entry with the possible occluders of a square that contains each, or all bits
  virtual void query_visibility(std::span<const Square> squares, std::span<SquareView> views) = 0;
};

/// Which squares of a product are tested for visibility.
enum class VisibilityTest {
  Leaves, ///< leaves of weight, after refinement; for queries that cost as much as a ray. Weights
          ///< are multiplied by the visible fraction, floored at 4 %
  Squares ///< all squares, during refinement, which then resolves shadow boundaries; for cheap
          ///< queries that return 0 only where nothing is visible. Weights are multiplied by the
          ///< square root of the visible fraction, floored above zero
};

/// Builds products adaptively from the root of the light tree: the reflectance's average over a
/// square is looked up in its own frame at the same level (the domain map is equal-area, so levels
/// match), and squares are split where weight times the reflectance's relative variance is large.
/// Clarberg and Akenine-Möller 2008 ("Practical product importance sampling for direct
/// illumination") do this with point evaluations; averages overlook no lobe. Memory is reused from
/// point to point. Visibility changes the density only, never to zero where something may be
/// visible: the integral stays that of light and reflectance.
class AdaptiveProduct {
public:
  /// @param light a tree in the frame that reflections are given in; its arrays must outlive this
  explicit AdaptiveProduct(const TreeView& light);
  ~AdaptiveProduct();
  AdaptiveProduct(const AdaptiveProduct&) = delete;
  AdaptiveProduct& operator=(const AdaptiveProduct&) = delete;

  /// The product at one shading point; valid until the next call.
  /// @param visibility nullptr for none
  const ProductTree& build(const RotatedReflectance& reflectance, const AdaptiveOptions& options,
                           SquareVisibility* visibility = nullptr,
                           VisibilityTest test = VisibilityTest::Leaves);

  /// As build() with VisibilityTest::Leaves, but reuses the last product if its shading point is so
  /// close that this adds less than `reuse_variance_bound`, and if that was built or reused without
  /// VisibilityTest::Squares. A reused product's density is above 0 wherever this point's integrand
  /// is, but its integral is that of the point it was built for.
  const ProductTree& build_or_reuse(const RotatedReflectance& reflectance,
                                    const AdaptiveOptions& options,
                                    SquareVisibility* visibility = nullptr);

private:
  class Builder;
  std::unique_ptr<Builder> m_builder;
};

/// A leaf of a product and of visibilities that some light reaches.
struct MaskedLeaf {
  Float4 visible_light = {}; ///< average over the square of light times masks, lanes R, G, B, *
  Square square;

private:
  friend class MaskedProduct;
  Float4 m_light = {}; ///< average of the light alone
  std::uint32_t m_node = no_node;
  float m_scale = 1;              ///< product of the masks that are constant over the square
  std::uint32_t m_first_mask = 0; ///< of those that are not
  std::uint32_t m_mask_count = 0;
};

/// An adaptive product times any number of masks, such as the visibilities of objects: traverses
/// the product's and the masks' trees together. Below a leaf, where the reflectance counts as
/// constant, it continues through the light's and the masks' trees as far as two of them have
/// detail: exact for all of these. Memory is reused from product to product.
class MaskedProduct {
public:
  /// The leaves with reflectance and visible light; valid until the next call.
  /// @param product of an AdaptiveProduct; must outlive the leaves, and so must the masks
  /// @param masks   of a single channel
  std::span<const MaskedLeaf> build(const ProductTree& product, std::span<const TreeView> masks);

  /// Appends the quadrants of a leaf of this product that some light reaches.
  /// @param leaf is copied: it may be one of `out`
  void split(MaskedLeaf leaf, std::vector<MaskedLeaf>& out);

private:
  /// A mask that varies over a square.
  struct Mask {
    const TreeView* tree = nullptr;
    std::uint32_t node = no_node;
    float mean = 0;
  };
  /// Its quadrants.
  struct MaskQuadrants {
    const TreeView* tree = nullptr;
    TreeQuadrants quadrants;
  };
  /// Masks from `first` on vary; `scale` is the product of the others.
  struct Masks {
    std::size_t first = 0;
    float scale = 1;
  };

  void visit(std::int32_t child, Masks masks);
  Float4 average_below(Float4 light, std::uint32_t node, Masks masks);
  void add_leaf(MaskedLeaf leaf, Masks masks, std::vector<MaskedLeaf>& out);
  void split_masks(Masks masks);
  Masks masks_of_quadrant(unsigned q, std::size_t splits, float scale);

  const ProductTree* m_product = nullptr;
  const TreeView* m_light = nullptr;
  std::vector<Mask> m_masks; ///< a stack, like the next
  std::vector<MaskQuadrants> m_splits;
  std::vector<MaskedLeaf> m_leaves;
  std::vector<Mask> m_leaf_masks; ///< those that vary over leaves
};

} // namespace haarlight::wavelet
