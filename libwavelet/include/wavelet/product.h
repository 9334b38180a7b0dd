#pragma once
// Products of a light tree and a reflectance, as something to sample: a quadtree over the light's
// square whose leaves are squares on which one factor counts as constant, so that below them the
// product has the detail of the light tree.
//
// The density follows the luminance of the product, not the product of luminances: a leaf weighs
// the light's channels by luminance weight times reflectance.

#include <wavelet/descent.h>
#include <wavelet/pyramid.h>
#include <wavelet/symmetry.h>
#include <wavelet/tree.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {

/// Four quadrants q = qx + 2 qy: the product's average weight over each, and what lies there: a
/// node, or the leaf ~child.
struct ProductNode {
  Float4 weights = {};
  std::int32_t child[4] = {-1, -1, -1, -1};
};

/// A square on which the reflectance counts as constant: the light tree's share of it.
struct ProductLeaf {
  Float4 mean;    ///< of the light, lanes R, G, B, 0
  Float4 weights; ///< luminance weights times reflectance
  std::uint32_t node;
};

/// A product ready for sampling. Points are those of the light's square; measures per unit square.
class ProductTree {
public:
  /// ∫ L·B over the square, per channel; times 4π for solid angle.
  Rgb integral() const { return m_integral; }

  /// Nothing to sample: the product vanishes.
  bool empty() const { return m_nodes.empty() || !(mean() > 0); }

  std::size_t leaf_count() const { return m_leaves.size(); }
  std::size_t bytes() const {
    return m_nodes.size() * sizeof(ProductNode) + m_leaves.size() * sizeof(ProductLeaf);
  }

  /// Draws a point of the square; result.pdf is its density per unit square.
  /// @param u1,u2 in [0, 1); must not be empty()
  Descent sample(float u1, float u2) const;

  /// The density of sample() at a point, per unit square.
  float pdf(float u, float v) const;

private:
  friend class AdaptiveProduct;
  friend class TableProduct;

  /// Turns node weights, given at leaves, into averages all the way up.
  void sum_upwards(const std::vector<std::int32_t>& parent_slots);

  /// Average weight over the whole square.
  float mean() const { return 0.25F * lane_sum(m_nodes[0].weights); }

  TreeDensity density(std::int32_t leaf) const {
    const ProductLeaf& l = m_leaves[static_cast<std::size_t>(leaf)];
    return {&m_light, l.node, l.mean, l.weights};
  }

  TreeView m_light;
  std::vector<ProductNode> m_nodes;
  std::vector<ProductLeaf> m_leaves;
  Rgb m_integral = Rgb::Zero();
};

/// A reflectance set's entry pair seen from a light's frame: what the product at one shading point
/// needs.
struct RotatedReflectance {
  const Pyramid* pyramid = nullptr;
  int entry0 = 0; ///< two neighbouring entries (θ_r) …
  int entry1 = 0;
  float blend = 0;            ///< … and the weight of the second
  ReflectionFrame reflection; ///< the pyramid's local frame, in the light's axes
};

struct AdaptiveOptions {
  /// Refine until the relative variance that is left, by estimate, is below this.
  float variance_bound = 0.03F;
  int max_leaves = 4096;
};

/// Builds products adaptively from the root of the light tree: the reflectance's average over a
/// square is looked up in its own frame at the same level (the domain map is equal-area, so levels
/// match), and squares are split where weight times the reflectance's relative variance is large.
/// Clarberg and Akenine-Möller 2008 ("Practical product importance sampling for direct
/// illumination") do this with point evaluations; averages overlook no lobe. Reused from point to
/// point, it allocates nothing.
class AdaptiveProduct {
public:
  /// @param light a tree in the frame that reflections are given in; its arrays must outlive this
  explicit AdaptiveProduct(const TreeView& light);

  /// The product at one shading point; valid until the next call.
  const ProductTree& build(const RotatedReflectance& reflectance, const AdaptiveOptions& options);

private:
  static constexpr int start_level = 3;

  struct Square {
    Float4 light;       ///< average, lanes R, G, B, 0
    Float4 reflectance; ///< average, and its luminance's deviation in lane 3
    std::uint32_t node;
    std::int32_t slot; ///< 4 × its parent's product node + quadrant
    std::uint16_t x, y;
    std::int32_t level;
    float weight; ///< share in the total: area × density
    float error;  ///< what of the variance it leaves
  };

  /// A square about to be replaced by its four quadrants.
  struct Family {
    Float4 light;
    std::uint32_t node;
    std::int32_t product_node;
    int level, x, y;
    std::uint32_t place; ///< of the square in m_squares, taken over by a quadrant, or no_place
  };

  /// The four quadrants of a family.
  struct Quadrants {
    Pyramid::Places places;
    Int4 visible; ///< whether any of the quadrant lies above the horizon
    std::array<Float4, 4> light;
    std::array<Float4, 4> reflectance;
    Float4 weight;
    Float4 error;
  };

  static constexpr std::uint32_t no_place = 0xffffffffU;
  /// Families are worked on this many at a time, stage by stage: a stage's steps are independent of
  /// each other, so that the processor overlaps them.
  static constexpr std::size_t batch_size = 16;

  void start();
  void place(const Family& family, Quadrants& quadrants) const;
  void look_up(Quadrants& quadrants) const;
  void weigh(const Family& family, Quadrants& quadrants) const;
  void add(const Family& family, const Quadrants& quadrants);
  void expand(std::span<const Family> families);
  Family split(std::uint32_t index);
  void refine(const AdaptiveOptions& options);
  void refine_above(float threshold, std::size_t limit);
  void finish();

  TreeView m_light;
  std::vector<Family> m_start;
  RotatedReflectance m_reflectance;
  Float4 m_floor = {};
  std::vector<Square> m_squares;
  std::vector<std::uint32_t> m_fresh; ///< squares not yet held against the pass's threshold
  std::vector<std::uint32_t> m_added; ///< squares made meanwhile
  std::vector<Family> m_families;
  std::vector<std::int32_t> m_parent_slots;
  double m_weight = 0;
  double m_error = 0;
  ProductTree m_product;
};

/// The exact product of two stored trees in one frame, by walking both at once: where one tree ends
/// its factor is constant, and the product is the other's. Gives the averages that OPPRODUCT of the
/// paper (Table 4) finds through coefficient sums.
class TableProduct {
public:
  /// @param light       its arrays must outlive the result
  /// @param reflectance seen through `symmetry`
  static ProductTree build(const TreeView& light, const TreeView& reflectance,
                           const SquareSymmetry& symmetry);

private:
  struct Builder;
};

} // namespace haarlight::wavelet
