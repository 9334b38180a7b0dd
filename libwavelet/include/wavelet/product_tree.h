#pragma once
// A product of a light tree and a reflectance as something to sample: a quadtree over the light's
// square whose leaves are squares on which one factor counts as constant, so that below them the
// product has the detail of the light tree.
//
// The density follows the luminance of the product, not the product of luminances: a leaf weighs
// the light's channels by luminance weight times reflectance.

#include <wavelet/descent.h>
#include <wavelet/tree.h>

#include <cstdint>
#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Four quadrants q = qx + 2 qy: the product's average weight over each, and what lies there: a
/// node, or the leaf ~child.
struct ProductNode {
  Float4 weights = {};
  std::int32_t child[4] = {-1, -1, -1, -1};
};

/// A square on which the reflectance counts as constant: the light tree's share of it. Columns and
/// rows count squares of the leaf's level.
struct ProductLeaf {
  Float4 light = {};       ///< average, lanes R, G, B, 0
  Float4 reflectance = {}; ///< average, lanes R, G, B
  std::uint32_t node = no_node;
  std::int32_t slot = -1; ///< 4 × its parent's product node + quadrant
  std::int32_t level = 0;
  std::uint16_t x = 0, y = 0;
};

/// A product ready for sampling. Points are those of the light's square; measures per unit square.
class ProductTree {
public:
  /// ∫ L·B over the square, per channel; times 4π for solid angle.
  Rgb integral() const;

  /// Nothing to sample: the product vanishes.
  bool empty() const { return m_nodes.empty() || !(mean() > 0); }

  std::size_t leaf_count() const { return m_leaf_count; }
  std::size_t bytes() const {
    return m_nodes.size() * sizeof(ProductNode) + m_leaves.size() * sizeof(ProductLeaf);
  }

  /// Draws a point of the square; result.pdf is its density per unit square.
  /// @param u1,u2 in [0, 1); must not be empty()
  Descent sample(float u1, float u2) const;

  /// sample() for many points at once, which hides what each waits for.
  /// @param points in [0, 1)², as many as out
  void sample(std::span<const Vec2> points, std::span<Descent> out) const;

  /// The density of sample() at a point, per unit square.
  float pdf(float u, float v) const;

private:
  friend class AdaptiveProduct;
  friend class TableProduct;

  /// Turns node weights, given at leaves, into averages all the way up.
  void sum_upwards(const std::vector<std::int32_t>& parent_slots);

  std::int32_t descend_nodes(Descent& d) const;

  std::int32_t& child(std::int32_t slot) {
    return m_nodes[static_cast<std::uint32_t>(slot) / 4].child[slot & 3];
  }

  /// A leaf's share in the total.
  float weight(const ProductLeaf& leaf) const {
    return m_nodes[static_cast<std::uint32_t>(leaf.slot) / 4].weights[leaf.slot & 3] *
           power_of_two(-2 * leaf.level);
  }

  /// Average weight over the whole square.
  float mean() const { return 0.25F * lane_sum(m_nodes[0].weights); }

  TreeDensity density(std::int32_t leaf) const {
    const ProductLeaf& l = m_leaves[static_cast<std::size_t>(leaf)];
    const Float4 weights = larger(l.reflectance, m_floor) * luminance_lanes;
    return {l.node, lane_sum(l.light * weights), weights};
  }

  TreeView m_light;
  Float4 m_floor = {}; ///< of the reflectance, in the density
  std::vector<ProductNode> m_nodes;
  std::vector<ProductLeaf> m_leaves;
  std::size_t m_leaf_count = 0;
};

} // namespace haarlight::wavelet
