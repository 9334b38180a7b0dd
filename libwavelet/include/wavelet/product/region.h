#pragma once
// Trees of functions that are constant over large parts of the square, such as visibilities: found
// by classifying squares from the root down, so that only what the boundary crosses is ever looked
// at.

#include <wavelet/product/factor.h>
#include <wavelet/tree/tree.h>

#include <cstdint>
#include <vector>

namespace haarlight::wavelet {

/// What is known of a function over a square.
enum class RegionPart : std::uint8_t {
  Outside, ///< 0 everywhere
  Inside,  ///< 1 everywhere
  Partial  ///< both, or neither, or unknown
};

/// A function on the unit square; of a part of it, 1 inside and 0 outside.
class Region {
public:
  virtual ~Region() = default;

  /// Never wrong, but Partial where it would be hard to tell; of any square, the root included.
  virtual RegionPart classify(const SquarePlace& square) const = 0;

  /// Average over a square, of a part the share that is inside; asked of the finest squares that
  /// are Partial.
  virtual float coverage(const SquarePlace& square) const = 0;
};

/// Builds the trees of one region after another; allocates nothing once its arrays have grown.
class RegionTreeBuilder {
public:
  /// The region's Haar tree: float coefficients of a single channel.
  /// @param levels finest squares have side 2^-levels; 0 … 15
  /// @param out    overwritten; its arrays are used again
  void build(const Region& region, int levels, Tree& out);

private:
  /// A square with its quadrants' averages.
  struct Node {
    std::uint32_t column = 0;
    std::uint32_t row = 0;
    float averages[4] = {};
    std::uint32_t children[4] = {no_node, no_node, no_node, no_node};
    bool kept = false; ///< not constant

    float average() const {
      return 0.25F * ((averages[0] + averages[1]) + (averages[2] + averages[3]));
    }
  };

  void split_level(const Region& region, int level, int levels);
  void sum_upwards();
  void write_level(std::size_t level, Tree& out) const;

  std::vector<Node> m_nodes; ///< breadth first
  std::vector<std::size_t> m_level_begin;
};

/// RegionTreeBuilder::build() for once.
Tree region_tree(const Region& region, int levels);

} // namespace haarlight::wavelet
