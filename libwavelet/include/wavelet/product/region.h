#pragma once
// Trees of functions that are constant over large parts of the square, such as visibilities:
// squares are classified from the root down, so that only those that the boundary crosses are
// evaluated.

#include <wavelet/square/square.h>
#include <wavelet/tree/tree.h>

#include <cstdint>
#include <vector>

namespace haarlight::wavelet {

/// Classification of a square.
enum class RegionPart : std::uint8_t {
  Outside, ///< 0 everywhere
  Inside,  ///< 1 everywhere
  Partial  ///< anything else, or unknown
};

/// A function on the unit square: the indicator of a region (1 inside, 0 outside), or any function
/// with values in between.
class Region {
public:
  virtual ~Region() = default;

  /// Conservative: may return Partial for squares that are fully inside or outside. Called for any
  /// square, the root included.
  virtual RegionPart classify(const Square& square) const = 0;

  /// Average over a square: of an indicator the fraction inside. Called for the finest squares that
  /// are Partial.
  virtual float coverage(const Square& square) const = 0;
};

/// Builds the trees of one region after another, reusing memory.
class RegionTreeBuilder {
public:
  /// The region's Haar tree: float coefficients of a single channel.
  /// @param levels finest squares have side 2^-levels; 0 … 15
  /// @param out    overwritten; its arrays are reused
  void build(const Region& region, int levels, Tree& out);

private:
  struct Node {
    Square square;
    float averages[4] = {}; ///< of the quadrants
    std::uint32_t children[4] = {no_node, no_node, no_node, no_node};
    bool kept = false; ///< not constant
  };

  void split(const Region& region, std::size_t node, int levels);
  void sum_upwards();

  std::vector<Node> m_nodes; ///< breadth first
};

/// RegionTreeBuilder::build() for a single region.
Tree region_tree(const Region& region, int levels);

} // namespace haarlight::wavelet
