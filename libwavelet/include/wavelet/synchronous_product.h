#pragma once
// The product of n functions in one frame, by walking all of them at once.

#include <wavelet/factor.h>
#include <wavelet/product_tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {
namespace detail {

/// One factor of a product, over some squares' quadrants.
struct ProductFactor {
  Float4* means;
  std::uint32_t* details; ///< its handles
  Float4 floor;           ///< of the product of the others, in the density
  std::int32_t is_tree;   ///< 0 or −1: what is left may be left to it
};

struct ProductRun;

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
  /// Squares of a level that are about to be split, as every factor sees them. Arrays never shrink.
  struct Frontier {
    std::size_t count = 0;
    std::vector<SquarePlace> places;
    std::vector<std::vector<Float4>> means; ///< by factor
    std::vector<std::vector<std::uint32_t>> details;

    void make_room(std::size_t factors, std::size_t squares);
  };

  void look_at_factors();
  void start();
  Float4 split_level(std::int32_t level);
  void split_run(std::size_t begin, detail::ProductRun& run);
  void queue(const detail::ProductRun& run);
  void queue_places(std::size_t begin, const detail::ProductRun& run);

  std::span<const Factor* const> m_factors;
  int m_finest_level = 0;
  bool m_needs_places = false;
  Frontier m_now;
  Frontier m_next;
  std::int32_t m_first_node = 0; ///< product node of m_now's first square
  std::size_t m_leaf_count = 0;
  std::vector<std::vector<Float4>> m_quadrant_means;
  std::vector<std::vector<std::uint32_t>> m_quadrant_details;
  std::vector<detail::ProductFactor> m_views;
  std::vector<std::int32_t> m_parent_slots;
  ProductTree m_product;
};

} // namespace haarlight::wavelet
