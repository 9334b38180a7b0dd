#pragma once
// The product of n trees in one frame, by traversing all of them at once.

#include <wavelet/product/product_tree.h>
#include <wavelet/square/symmetry.h>

#include <array>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Many squares as one factor sees them: square i has the average mean[slot[i]] and the node
/// node[slot[i]], no_node where the factor is constant.
struct FactorSquares {
  const std::int32_t* slot;
  const Float4* mean; ///< lanes R, G, B, *
  const std::uint32_t* node;
  std::size_t count;
};

/// The quadrants q = qx + 2 qy of square i, at 4 i + q.
struct FactorQuadrants {
  Float4* mean;
  std::uint32_t* node;
};

/// A factor of a product: a stored tree, seen through a symmetry of the square. All factors of a
/// product share one frame.
class TreeFactor {
public:
  /// @param view its arrays must outlive this
  explicit TreeFactor(const TreeView& view, const SquareSymmetry& symmetry = {});

  /// Average over the whole square, lanes R, G, B, 0.
  Float4 mean() const { return to_lanes(m_view.mean); }
  std::uint32_t root() const { return m_view.root(); }

  /// Averages and nodes of the squares' quadrants.
  void split(const FactorSquares& squares, const FactorQuadrants& out) const;

  /// The tree, which a product is left to where all other factors are constant; nullptr if it is
  /// seen through a symmetry other than the identity, which samples do not follow.
  const TreeView* tree() const { return m_turn.identity ? &m_view : nullptr; }

  /// How a symmetry of the square moves a node's quadrants and differences.
  struct Turn {
    std::array<unsigned, 4> stored; ///< the stored quadrant that each one shows
    bool identity;
    bool swaps;           ///< differences along x are stored along y
    float sign_x, sign_y; ///< of the differences along x and y, as they are seen

    explicit Turn(const SquareSymmetry& symmetry);
  };

private:
  TreeView m_view;
  Turn m_turn;
};

/// Visits, level by level, the squares on which at least two factors have detail. Where at most one
/// has detail and can be sampled, the product is a constant times its tree: exact, and what
/// OPPRODUCT of the paper (Table 4) and its chaining over n factors find through sums of
/// coefficient products. The time is linear in the squares visited and in n. Memory is reused from
/// product to product.
class SynchronousProduct {
public:
  /// The product as a density to sample, with its integral; valid until the next call.
  /// @param factors      1 to 255; their trees must outlive the result
  /// @param finest_level squares of this level are not split; ≥ 1
  const ProductTree& build(std::span<const TreeFactor> factors, int finest_level = 15);

  /// One factor of a product. Arrays go by slot: 4 × product node + quadrant.
  struct FactorSlots {
    Float4* means;           ///< over the quadrants, lanes R, G, B, *
    std::uint32_t* nodes;    ///< of the quadrants
    Float4 floor;            ///< of the product of the others, in the density
    std::int32_t can_remain; ///< −1 if leaves can be left to its tree, else 0
  };

private:
  /// Nodes that are split together: few enough to stay in the cache.
  static constexpr std::size_t run = 32;

  void prepare_factors();
  void make_room(std::size_t begin, std::size_t end);
  void start();
  void split(std::size_t begin, std::size_t end, std::int32_t level);
  void add_quadrants(std::size_t begin, std::size_t end, std::int32_t level);

  std::span<const TreeFactor> m_factors;
  int m_finest_level = 0;
  std::size_t m_node_count = 0;
  Float4 m_integral = {};
  std::vector<FactorSlots> m_slots;
  std::vector<std::int32_t> m_parent_slots; ///< by node
  ProductTree m_product;
};

} // namespace haarlight::wavelet
