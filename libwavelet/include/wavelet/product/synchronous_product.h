#pragma once
// The product of n functions in one frame, by walking all of them at once.

#include <wavelet/product/factor.h>
#include <wavelet/product/product_tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {
namespace detail {

/// One factor of a product. Arrays go by slot: 4 × product node + quadrant.
struct ProductFactor {
  Float4* means;          ///< over the quadrants, lanes R, G, B, *
  std::uint32_t* details; ///< its handles on them
  Float4 floor;           ///< of the product of the others, in the density
  std::int32_t is_tree;   ///< 0 or −1: what is left may be left to it
};

} // namespace detail

/// Visits, level by level, the squares on which at least two factors have detail. Where at most one
/// is left and that is a tree, the product is a constant times this tree and nothing more needs
/// doing: exact for trees, and what OPPRODUCT of the paper (Table 4) and its chaining over n
/// factors find through sums of coefficient products. The time is linear in the squares visited and
/// in n. Nothing is hashed; the arrays are reused from product to product.
class SynchronousProduct {
public:
  /// The product as something to sample, to integrate and to average; valid until the next call.
  /// @param factors      1 to 255; trees behind them must outlive the result
  /// @param finest_level squares of this level are not split, whatever they hold; ≥ 1
  const ProductTree& build(std::span<const Factor* const> factors, int finest_level = 15);

private:
  /// Nodes that are split together: few enough that they stay in the cache.
  static constexpr std::size_t run = 32;

  void look_at_factors();
  void make_room(std::size_t begin, std::size_t end);
  void start();
  void split(std::size_t begin, std::size_t end, std::int32_t level);
  void finish(std::size_t begin, std::size_t end, std::int32_t level);
  void find_places(std::size_t begin, std::size_t end);

  std::span<const Factor* const> m_factors;
  int m_finest_level = 0;
  bool m_needs_places = false;
  std::size_t m_node_count = 0;
  Float4 m_integral = {};
  std::vector<detail::ProductFactor> m_views;
  std::vector<std::int32_t> m_parent_slots; ///< by node
  std::vector<SquarePlace> m_places;        ///< by node, if a factor needs them
  ProductTree m_product;
};

} // namespace haarlight::wavelet
