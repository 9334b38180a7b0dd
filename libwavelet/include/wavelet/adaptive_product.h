#pragma once
// Products of a light tree and a reflectance seen through a rotation, built on the fly.

#include <wavelet/product_tree.h>
#include <wavelet/pyramid.h>

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
  float drift_bound = 0.004F;
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

/// A square about to be replaced by its four quadrants.
struct Family {
  Float4 light; ///< average, lanes R, G, B, 0
  std::uint32_t node;
  std::int32_t product_node;
  std::int32_t level;
  std::uint16_t x, y;
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

  /// The same at a point close to that of the last product. That is kept as it is while what has
  /// changed since it was weighed is little, by how fast it changed before: its density is above 0
  /// wherever this point's integrand is, but its integral is another point's. Else its squares are
  /// weighed anew and refining goes on: to the same bound, in less time than build() and with
  /// somewhat more leaves. Builds afresh if that had another pyramid, or has grown by following.
  const ProductTree& follow(const RotatedReflectance& reflectance, const AdaptiveOptions& options,
                            const Occlusion* occlusion = nullptr);

private:
  using Family = detail::Family;

  void turn_to(const RotatedReflectance& reflectance, const AdaptiveOptions& options);
  void start();
  float weigh_again();
  bool serves(float squared_shift, float drift_bound) const;
  float squared_shift(const ReflectionFrame& reflection) const;
  void refine(const AdaptiveOptions& options);
  const ProductTree& finish(const AdaptiveOptions& options, const Occlusion* occlusion);
  void mask(const AdaptiveOptions& options, const Occlusion& occlusion);
  bool hide(const Occlusion& occlusion);
  void find_candidates();
  void keep(std::uint32_t leaf, float share);
  void unmask();
  double excess_error(const AdaptiveOptions& options) const;
  void split_above(float threshold);
  void expand_all(float threshold);
  void add(const Family& family, const detail::Quadrants& quadrants, float threshold);
  float threshold(double excess) const;
  void split(const ProductLeaf& square, Family& family);
  std::uint32_t new_leaf();
  std::int32_t new_node(std::int32_t slot);

  TreeView m_light;
  std::vector<Family> m_start; ///< the same for every product
  RotatedReflectance m_reflectance;
  std::size_t m_limit = 0;
  std::vector<Family> m_families; ///< being replaced
  std::vector<Family> m_next;     ///< to be replaced after them
  std::vector<float> m_errors;    ///< what each leaf leaves of the variance, by estimate
  std::vector<detail::LeafShare> m_shares;
  std::vector<std::uint32_t> m_free;       ///< leaves no longer in use
  bool m_masked = false;                   ///< some leaf's share is not all of it
  std::vector<std::uint32_t> m_candidates; ///< leaves to be tested
  std::vector<Vec3> m_directions;
  std::vector<std::uint8_t> m_hidden;
  std::vector<std::int32_t> m_parent_slots;
  ProductLeaf m_split;            ///< on its way from quadrant to family
  std::size_t m_fresh_leaves = 0; ///< of the last product that followed none
  float m_drift_rate = 0;         ///< variance added per squared radian; below 0 if unknown
  double m_weight = 0;
  double m_error = 0;
  ProductTree m_product;
};

} // namespace haarlight::wavelet
