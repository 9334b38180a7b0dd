#pragma once
// Products of a light tree and a reflectance seen through a rotation, built on the fly.

#include <wavelet/product/product_tree.h>
#include <wavelet/product/square_visibility.h>
#include <wavelet/tree/pyramid.h>

#include <span>
#include <vector>

namespace haarlight::wavelet {

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
  /// Relative variance, by estimate, that follow() may add by keeping a product as it is.
  float drift_bound = 0.01F;
};

/// What stands between a point and the light.
class Occlusion {
public:
  virtual ~Occlusion() = default;

  /// Sets each of `out` to whether something is in the way of a direction in the light's frame; as
  /// many as `directions`.
  virtual void find(std::span<const Vec3> directions, std::span<std::uint8_t> hidden) const = 0;
};

namespace detail {

/// What a leaf weighs.
struct LeafShare {
  float density = 0; ///< the product's average weight, whatever is in the way
  float kept = 1;    ///< of it
  bool tested = false;
};

struct Quadrants;

} // namespace detail

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
  /// @param occlusion if given, squares of weight whose centres are hidden from the point get
  /// little of the density, never none; the product's integral stays that of light and reflectance
  const ProductTree& build(const RotatedReflectance& reflectance, const AdaptiveOptions& options,
                           const Occlusion* occlusion = nullptr);

  /// The same where squares get the density that what is seen of them is worth, but never none; the
  /// product's integral stays that of light and reflectance. Much refined where shadows end.
  const ProductTree& build(const RotatedReflectance& reflectance, const AdaptiveOptions& options,
                           SquareVisibility& visibility);

  /// The first at a point close to that of the last product. That is kept as it is while little has
  /// changed since it was built: its density is above 0 wherever this point's integrand is, but its
  /// integral is another point's. Else it is built afresh.
  const ProductTree& follow(const RotatedReflectance& reflectance, const AdaptiveOptions& options,
                            const Occlusion* occlusion = nullptr);

private:
  void turn_to(const RotatedReflectance& reflectance, const AdaptiveOptions& options);
  void start();
  bool serves(const RotatedReflectance& reflectance, float drift_bound) const;
  float drift_rate() const;
  double drift_of(std::uint32_t slot) const;
  float squared_shift(const ReflectionFrame& reflection) const;
  void refine(const AdaptiveOptions& options);
  const ProductTree& finish(const AdaptiveOptions& options, const Occlusion* occlusion);
  void mask(const AdaptiveOptions& options, const Occlusion& occlusion);
  bool hide(const Occlusion& occlusion);
  void find_candidates();
  void keep(std::uint32_t slot, float share);
  void unmask();
  void look(std::size_t first, std::span<detail::Quadrants> quadrants);
  void find_lookouts(std::size_t first, std::span<const detail::Quadrants> quadrants);
  void keep(std::uint32_t slot, float seen, detail::Quadrants& quadrants) const;
  double excess_error(const AdaptiveOptions& options) const;
  void split_above(float threshold);
  void expand(std::size_t first_node, float threshold);
  void see_light(std::size_t node, detail::Quadrants& quadrants);
  void add_leaves(std::size_t node, const detail::Quadrants& quadrants, float threshold);
  void set_leaf(std::uint32_t slot, const detail::Quadrants& quadrants, std::size_t q);
  float threshold(double excess) const;
  bool has_room() const { return m_product.leaf_count() + 3 <= m_limit; }
  void split(std::uint32_t slot);
  void new_node(std::int32_t slot, const SquarePlace& square);

  std::size_t slot_count() const { return 4 * m_product.m_nodes.size(); }
  bool is_leaf(std::uint32_t slot) const {
    return m_product.m_nodes[slot / 4].child[slot & 3U] < 0;
  }
  SquarePlace square(std::uint32_t slot) const { return m_squares[slot / 4].quadrant(slot & 3U); }
  float area(std::uint32_t slot) const {
    return power_of_two(-2 * (m_squares[slot / 4].level + 1));
  }

  TreeView m_light;
  std::vector<ProductLeaf> m_start; ///< of the nodes that are the same for every product
  RotatedReflectance m_reflectance;
  std::size_t m_limit = 0;
  std::vector<SquarePlace> m_squares; ///< by node
  std::vector<std::int32_t> m_parent_slots;
  std::vector<float> m_errors; ///< by slot, or longer: what each leaf leaves of the variance, by
                               ///< estimate; 0 where there is a node
  std::vector<detail::LeafShare>
      m_shares;          ///< by slot, or longer; of density 0 where there is a node
  bool m_masked = false; ///< some leaf's share is not all of it
  std::vector<std::uint32_t> m_candidates;  ///< slots of leaves to be tested
  SquareVisibility* m_visibility = nullptr; ///< while a product is built by it
  std::vector<std::uint64_t> m_occluders;   ///< by slot, of squares that were looked at
  std::vector<SquarePlace> m_places;        ///< of candidates
  std::vector<SquareView> m_views;
  std::vector<Vec3> m_directions;
  std::vector<std::uint8_t> m_hidden;
  double m_weight = 0;
  double m_error = 0;
  double m_drift = 0; ///< of the leaves, see drift_rate()
  ProductTree m_product;
};

} // namespace haarlight::wavelet
