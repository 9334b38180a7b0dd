#pragma once
// A product of functions as a density to sample: a quadtree whose leaves are squares on which all
// factors but one count as constant. Below a leaf the product has the detail of the tree of the
// remaining factor, mostly the light.
//
// The density follows the luminance of the product, not the product of luminances: a leaf weights
// the colours of the remaining factor by luminance weight times the constants.

#include <wavelet/square/square.h>
#include <wavelet/tree/descent.h>
#include <wavelet/tree/tree.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Four quadrants q = qx + 2 qy: the product's average weight over each, and the node below it, or
/// the leaf of slot ~child. Slots number quadrants: 4 × node + q.
struct ProductNode {
  Float4 weights = {};
  std::int32_t child[4] = {-1, -1, -1, -1};
};

/// A square on which all factors but one count as constant.
struct ProductLeaf {
  Float4 light = {};            ///< average of the remaining factor, lanes R, G, B, *
  Float4 reflectance = {};      ///< product of the other factors' averages, lanes R, G, B
  Slope slope;                  ///< of the product, beside the detail of the remaining factor
  std::uint32_t node = no_node; ///< in the tree of the remaining factor
  Square square;                ///< set by AdaptiveProduct only
  std::uint8_t remaining = 0;   ///< index of the remaining factor
};
static_assert(sizeof(ProductLeaf) == 64);

/// A product ready for sampling. Points are those of the light's square; measures per unit square.
class ProductTree {
public:
  /// ∫ L·B over the square, per channel; times 4π for solid angle.
  Rgb integral() const;

  /// True if the product vanishes, so that there is nothing to sample.
  bool empty() const { return m_nodes.empty() || !(mean() > 0); }

  std::size_t leaf_count() const { return m_nodes.empty() ? 0 : 3 * m_nodes.size() + 1; }

  /// Nodes, parents before children; the first is the whole square.
  std::span<const ProductNode> nodes() const { return m_nodes; }

  /// The leaf that a node's negative child names.
  ProductLeaf leaf(std::int32_t child) const {
    return m_leaves.empty() ? leaf_at_slot(~child) : m_leaves[static_cast<std::uint32_t>(~child)];
  }

  /// The tree of a leaf's remaining factor.
  const TreeView& remaining_tree(std::uint32_t index) const { return m_remaining[index].tree; }

  std::size_t bytes() const {
    const std::size_t slots = 4 * m_nodes.size() * m_slots.size();
    return m_nodes.size() * sizeof(ProductNode) + m_leaves.size() * sizeof(ProductLeaf) +
           slots * (sizeof(Float4) + sizeof(std::uint32_t));
  }

  /// Draws a point of the square; result.pdf is its density per unit square.
  /// @param u1,u2 in [0, 1); must not be empty()
  Descent sample(float u1, float u2) const;

  /// sample() for many points at once, which hides memory latency.
  /// @param points in [0, 1)², as many as out
  void sample(std::span<const Vec2> points, std::span<Descent> out) const;

  /// The density of sample() at a point, per unit square.
  float pdf(float u, float v) const;

private:
  friend class AdaptiveProduct;
  friend class SynchronousProduct;

  /// A factor that may remain in leaves.
  struct RemainingFactor {
    TreeView tree;
    Float4 floor = {}; ///< of the product of the others, in the density; lanes R, G, B, 0
    /// Of the others in the density: luminance, scaled so that it stays within float.
    Float4 weights = luminance_lanes;
  };

  /// A factor's averages over the nodes' quadrants, and its nodes there.
  struct Slots {
    std::vector<Float4> means; ///< lanes R, G, B, *
    std::vector<std::uint32_t> nodes;
  };

  ProductLeaf leaf_at_slot(std::int32_t slot) const;

  /// Sets the weights of inner squares to the averages of their quadrants' weights.
  void sum_upwards(const std::vector<std::int32_t>& parent_slots);

  std::int32_t descend_nodes(Descent& d) const;

  std::int32_t& child(std::int32_t slot) {
    return m_nodes[static_cast<std::uint32_t>(slot) / 4].child[slot & 3];
  }

  /// The weight of a slot. There are no references to lanes of a vector.
  float& weight_at(std::int32_t slot) {
    auto* weights =
        reinterpret_cast<float*>(&m_nodes[static_cast<std::uint32_t>(slot) / 4].weights);
    return weights[slot & 3];
  }

  /// Average weight over the whole square.
  float mean() const { return 0.25F * lane_sum(m_nodes[0].weights); }

  TreeDensity density(std::int32_t child) const {
    return m_leaves.empty() ? density(leaf_at_slot(~child))
                            : density(m_leaves[static_cast<std::uint32_t>(~child)]);
  }

  TreeDensity density(const ProductLeaf& l) const {
    const RemainingFactor& factor = m_remaining[l.remaining];
    const Float4 weights = larger(l.reflectance, factor.floor) * factor.weights;
    return {&factor.tree, l.node, lane_sum(l.light * weights), weights, l.slope};
  }

  std::vector<RemainingFactor> m_remaining;
  std::vector<ProductNode> m_nodes;
  std::vector<ProductLeaf> m_leaves; ///< by slot, or longer; empty if they are made from m_slots
  std::vector<Slots> m_slots;        ///< by factor, then by slot
  std::optional<Rgb> m_integral;     ///< if known already
};

} // namespace haarlight::wavelet
