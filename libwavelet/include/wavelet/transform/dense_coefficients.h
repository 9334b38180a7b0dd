#pragma once
// A map's coefficients laid out for inner products with many sparse trees.

#include <wavelet/tree/map_set.h>
#include <wavelet/tree/tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {

/// All coefficients of one map, in the order of a complete tree: square 0 is the whole, quadrant q
/// of square i is square 4 i + 1 + q. An inner product then costs one multiply-add for each
/// coefficient of the sparse tree, whatever the map holds. Shared by threads once made.
class DenseCoefficients {
public:
  /// @param map of 2^levels pixels a side
  explicit DenseCoefficients(Map map);

  int levels() const { return m_levels; }
  /// Average over the whole.
  Rgb mean() const { return to_rgb(m_mean); }
  /// Differences of all squares in that order, times the squares' areas.
  std::span<const Details> details() const { return m_details; }

  /// ∫∫ F·T over the unit square for each tree T, per channel, by Parseval: colours times colours.
  /// @param trees of at most levels() levels
  /// @param out   as many as trees
  void inner_products(std::span<const TreeView> trees, std::span<Rgb> out) const;

private:
  Float4 detail_product(const TreeView& tree, std::vector<std::uint32_t>& squares) const;

  int m_levels;
  Float4 m_mean;
  std::vector<Details> m_details; ///< times the square's area
};

} // namespace haarlight::wavelet
