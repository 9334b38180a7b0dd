#pragma once
// Hierarchical sample warping: points are warped down a quadtree of weights (Clarberg et al. 2005).

#include <wavelet/product/product_tree.h>

#include <span>

namespace haarlight::renderer {

/// Returned in place of a leaf where weights are 0.
inline constexpr std::int32_t unreachable = -1;

/// The root: a node, or leaf 0 if there are none.
inline std::int32_t first_of(std::span<const wavelet::ProductNode> nodes) {
  return nodes.empty() ? ~0 : 0;
}

/// Descends from the root to a leaf; d.pdf becomes the density of reaching it, per unit square.
/// @param nodes weights ≥ 0, not all 0 in a reachable node; child ≥ 0 is a node, otherwise leaf
///              ~child
/// @return the leaf
inline std::int32_t warp_down(std::span<const wavelet::ProductNode> nodes, wavelet::Descent& d) {
  std::int32_t next = first_of(nodes);
  while (next >= 0) {
    const wavelet::ProductNode& node = nodes[static_cast<std::size_t>(next)];
    const unsigned q = wavelet::steer(d, node.weights);
    d.pdf *= wavelet::quadrant_density(node.weights, q);
    next = node.child[q];
  }
  return ~next;
}

/// warp_down() towards (u, v) of the square. @return the leaf, or `unreachable` with d.pdf = 0
inline std::int32_t warp_towards(std::span<const wavelet::ProductNode> nodes, float u, float v,
                                 wavelet::Descent& d) {
  std::int32_t next = first_of(nodes);
  while (next >= 0) {
    const wavelet::ProductNode& node = nodes[static_cast<std::size_t>(next)];
    const unsigned q = wavelet::steer_to(d, u, v);
    if (!(node.weights[q] > 0)) {
      d.pdf = 0;
      return unreachable;
    }
    d.pdf *= wavelet::quadrant_density(node.weights, q);
    next = node.child[q];
  }
  return ~next;
}

} // namespace haarlight::renderer
