#pragma once
// Products of trees and of a reflectance seen through a rotation, as sparse trees that hold no more
// than a tolerance asks for.
//
// multiply() keeps all that its factors have, and a reflectance has detail everywhere. A projection
// refines squares while they leave too much of the product's variation, sums the squares upwards
// and prunes what the tolerance can spare. It is how the transfer of one shading point is made: the
// fixed factors of its integral, all in one frame.

#include <wavelet/product/adaptive_product.h>
#include <wavelet/tree/tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {

/// The variance of luminance within the square of each node of a tree, by Parseval.
std::vector<float> variances_within(const TreeView& tree);

/// A factor that is a tree. Its arrays must outlive the projection.
struct ProjectionTerm {
  TreeView tree;
  /// variances_within(tree); nullptr for a coverage, all of whose values are 0 or 1 but for the
  /// finest squares: a square of mean m then has the variance m (1 − m).
  const float* variances = nullptr;
};

struct ProjectionOptions {
  int levels = 7; ///< of the trees made: squares of side 2^-levels are not split, 1 to 13
  /// Bound of sqrt(∫ (T' − T)²/T' / ∫ T) for the tree T' of a product T: the relative error, root
  /// mean square, of ∫ T·F where F is one small light whose place is distributed as T' is. Squares
  /// darker than 3 % of the mean count as if they were that bright. By estimate; what varies within
  /// the finest squares is left out.
  double tolerance = 0.1;
  CoefficientType coefficients = CoefficientType::Half;
};

/// What a projection cost, and what it left.
struct ProjectionReport {
  std::size_t squares = 0; ///< looked at
  double dropped = 0;      ///< the square of what the tolerance bounds
  double unresolved = 0;   ///< the same of what varies within the finest squares
};

/// Makes one tree after another; its arrays are reused.
class Projection {
public:
  explicit Projection(const ProjectionOptions& options) : m_options(options) {}

  /// Π of the terms and of the reflectance, colour by colour; RGB.
  /// @param terms       at most 255
  /// @param reflectance nullptr for none; its pyramid must outlive the call
  Tree make(std::span<const ProjectionTerm> terms, const RotatedReflectance* reflectance);

  /// The average of the last product, before anything was pruned.
  Rgb mean() const { return to_rgb(m_mean); }
  const ProjectionReport& report() const { return m_report; }

private:
  /// Share of the mean that a square's brightness counts as at least, as in Criterion::Variance.
  static constexpr float darkest = 0.03F;

  /// A square cut in four. Slot 4 × node + q is quadrant q.
  struct Node {
    std::int32_t level; ///< of the node itself
    std::uint16_t x, y;
    std::int32_t child[4]; ///< nodes, or −1
  };
  /// What one term has in each slot.
  struct Slots {
    std::vector<Float4> means;
    std::vector<std::uint32_t> nodes;
  };
  /// What pruning knows of a node.
  struct Cost {
    float own = 0;   ///< that dropping this node's differences adds to the error
    float under = 0; ///< and all those under it as well
  };

  void start();
  void refine();
  double split_above(float threshold);
  void add_node(std::int32_t level, std::uint32_t x, std::uint32_t y, std::int32_t slot);
  void split_terms(std::size_t node, std::int32_t slot);
  void multiply(std::size_t node);
  void look_up(std::size_t node);
  float error_of(std::size_t slot, int level) const;
  void sum_upwards();
  Float4 mean_of(std::size_t node) const;
  Details details_of(std::size_t node) const;
  void find_costs();
  float choose_limit();
  Tree written(float limit);
  float top_difference(float limit) const;
  std::uint32_t kept_children(std::size_t node, float limit) const;

  ProjectionOptions m_options;
  std::span<const ProjectionTerm> m_terms;
  const RotatedReflectance* m_reflectance = nullptr;
  Float4 m_mean = {};
  float m_brightness = 0; ///< mean luminance so far
  std::vector<Node> m_nodes;
  std::vector<Slots> m_slots;       ///< by term
  std::vector<Float4> m_looked;     ///< reflectance by slot, lane 3 its deviation
  std::vector<Float4> m_products;   ///< by slot
  std::vector<float> m_errors;      ///< by slot
  std::vector<std::int32_t> m_open; ///< slots that may be split
  std::vector<Cost> m_costs;
  std::vector<Cost> m_sorted;
  std::vector<std::int32_t> m_queue;
  ProjectionReport m_report;
};

} // namespace haarlight::wavelet
