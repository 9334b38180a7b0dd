#pragma once
// The product of n functions in one frame, by walking all of them at once.

#include <wavelet/factor.h>
#include <wavelet/product_tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Visits, level by level, the squares on which at least two factors have detail. Where at most one
/// is left and that is a tree, the product is a constant times this tree and nothing more needs
/// doing: exact for trees, and what OPPRODUCT of the paper (Table 4) and its chaining over n
/// factors find through sums of coefficient products. The time is linear in the squares visited and
/// in n. Nothing is hashed; the arrays are reused from product to product.
class SynchronousProduct {
public:
  /// The product as something to sample, to integrate and to average; valid until the next call.
  /// @param factors      at least one; trees behind them must outlive the result
  /// @param finest_level squares of this level are not split, whatever they hold; ≥ 1
  const ProductTree& build(std::span<const Factor* const> factors, int finest_level = 15);

private:
  /// Squares of a level that are about to be split, as every factor sees them.
  struct Frontier {
    std::vector<SquarePlace> places;
    std::vector<std::vector<Float4>> means; ///< by factor
    std::vector<std::vector<std::uint32_t>> details;

    void clear(std::size_t factors);
  };

  /// A run of squares is split together: small enough that their quadrants stay in the cache.
  static constexpr std::size_t run = 32;

  void start();
  void choose_floors();
  void split_run(std::size_t begin, std::size_t count);
  template <std::size_t Factors>
  void combine(std::size_t square, std::size_t index_in_run);
  void add_node(const SquarePlace& place, std::int32_t slot, std::size_t quadrant);
  void add_leaf(std::int32_t level, std::int32_t slot, std::size_t quadrant, std::size_t rest,
                bool cut);

  std::span<const Factor* const> m_factors;
  int m_finest_level = 0;
  Frontier m_now;
  Frontier m_next;
  std::int32_t m_first_node = 0; ///< product node of m_now's first square
  std::vector<std::vector<Float4>> m_quadrant_means;
  std::vector<std::vector<std::uint32_t>> m_quadrant_details;
  std::vector<std::int32_t> m_parent_slots;
  ProductTree m_product;
};

} // namespace haarlight::wavelet
