#include <wavelet/product/adaptive_product.h>

#include "product/reflectance_quadrants.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace haarlight::wavelet {
namespace {

/// All squares down to this level are evaluated before any is chosen for refinement: 64 of 22°, so
/// that no lobe whose average is stored is overlooked.
constexpr int start_level = 3;

/// The reflectance counts as at least this fraction of its mean wherever light can come from, so
/// that no direction of the integrand has density 0. Under even light it costs at most as large a
/// fraction of the samples.
constexpr float reflectance_floor = 0.005F;

/// Fraction of a square's error that a split is assumed to remove. The variance of a linear
/// function falls to a quarter (0.75 removed); lobes are not linear.
constexpr double gain_of_splitting = 0.6;

/// VisibilityTest::Leaves: leaves of a smaller fraction of the weight are not tested, which limits
/// the tests to 333 a round.
constexpr double smallest_tested_fraction = 0.003;

/// VisibilityTest::Leaves: least weight of a hidden leaf. A sample through a leaf that its rays
/// took for hidden by mistake weighs at most 25 times as much.
constexpr float least_weight_of_hidden_leaf = 0.04F;

/// VisibilityTest::Leaves: hidden leaves move the weight to others, which are then refined and
/// tested.
constexpr int visibility_rounds = 3;

/// VisibilityTest::Squares: weight of a square of which nothing is visible. Not 0, because rays and
/// squares are rounded differently.
constexpr float least_visibility_weight = 1e-5F;

/// Number of half octaves between 1 and a ratio above it, at most 31: exponent and first mantissa
/// bit of the float.
std::size_t half_octave(float ratio) {
  return std::min((std::bit_cast<std::uint32_t>(ratio) >> 22U) - (127U << 1U), 31U);
}

/// The least ratio of a half octave: 1, 1.5, 2, 3, …
float half_octave_start(std::size_t index) {
  return std::bit_cast<float>((static_cast<std::uint32_t>(index) + (127U << 1U)) << 22U);
}

/// Every product has the nodes of all levels below start_level; those of the last of these levels
/// have the first leaves.
constexpr std::size_t nodes_above(int level) { return ((1ULL << (2 * level)) - 1) / 3; }
constexpr std::size_t start_nodes = nodes_above(start_level);
constexpr std::size_t inner_nodes = nodes_above(start_level - 1);

/// Sets the averages and nodes of a square's quadrants in the light's tree.
void split_light(const TreeView& tree, const ProductLeaf& square, ProductLeaf* quadrants) {
  const TreeQuadrants split = tree.split(square.node, square.light);
  for (unsigned q = 0; q < 4; ++q) {
    quadrants[q].light = split.means[q];
    quadrants[q].node = split.nodes[q];
  }
}

/// Sum of the squared chords between the normals, and between the mirror directions, of two points.
float squared_shift(const ReflectionFrame& a, const ReflectionFrame& b) {
  const auto normal = [](const ReflectionFrame& r) -> Vec3 {
    return r.sin_theta_r * r.frame.t + r.cos_theta_r * r.frame.n;
  };
  return (a.frame.n - b.frame.n).squaredNorm() + (normal(a) - normal(b)).squaredNorm();
}

} // namespace

class AdaptiveProduct::Builder {
public:
  explicit Builder(const TreeView& light);

  const ProductTree& build(const RotatedReflectance& reflectance, const AdaptiveOptions& options,
                           SquareVisibility* visibility, VisibilityTest test);
  const ProductTree& reuse(const AdaptiveOptions& options, SquareVisibility* visibility);
  bool is_reusable(const RotatedReflectance& reflectance, float reuse_variance_bound) const;

private:
  /// The weight of a leaf.
  struct LeafWeight {
    float density =
        0; ///< the product's average weight, not counting visibility; 0 where there is a node
    float visibility_weight = 1; ///< factor of the density
    bool tested = false;         ///< for visibility
  };

  /// Sums over leaves.
  struct LeafSums {
    double weight = 0; ///< density times area
    double error = 0;  ///< estimated variance that the leaves leave
    double drift = 0;  ///< see Builder::drift_rate()
  };

  /// How a product is refined.
  struct Refinement {
    double variance_bound;
    std::size_t max_leaves;
    SquareVisibility* visibility; ///< nullptr unless all squares are tested
  };

  void set_shading_point(const RotatedReflectance& reflectance);
  float drift_rate() const;
  void start(const Refinement& refinement);
  void refine(const Refinement& refinement);
  float split_threshold(double excess) const;
  void split_above(float threshold, const Refinement& refinement);
  void expand(std::size_t node, float threshold, const Refinement& refinement);
  void add_leaves(std::size_t node, const detail::Quadrants& quadrants, float threshold,
                  const Refinement& refinement);
  void set_leaf(std::uint32_t slot, const detail::Quadrants& quadrants, std::size_t q);
  void split(std::uint32_t slot);
  void new_node(std::int32_t slot, const Square& square);

  const ProductTree& finish(const AdaptiveOptions& options, SquareVisibility* visibility);
  bool test_leaves(SquareVisibility& visibility);
  void test_quadrants(std::size_t first, std::span<detail::Quadrants> quadrants,
                      SquareVisibility& visibility);
  void set_leaf_visibility(std::uint32_t slot, float weight);
  void clear_leaf_visibility();

  std::size_t slot_count() const { return 4 * m_product.m_nodes.size(); }
  bool is_leaf(std::uint32_t slot) const {
    return m_product.m_nodes[slot / 4].child[slot & 3U] < 0;
  }
  Square square(std::uint32_t slot) const { return m_squares[slot / 4].quadrant(slot & 3U); }
  float area(std::uint32_t slot) const {
    return power_of_two(-2 * (m_squares[slot / 4].level + 1));
  }
  bool has_room(const Refinement& refinement) const {
    return m_product.leaf_count() + 3 <= refinement.max_leaves;
  }

  TreeView m_light;
  std::vector<ProductLeaf> m_start; ///< light of the inner nodes' quadrants, common to all products
  RotatedReflectance m_reflectance; ///< of the product; pyramid is nullptr if it cannot be reused
  ProductTree m_product;
  std::vector<Square> m_squares; ///< by node, like the next
  std::vector<std::int32_t> m_parent_slots;
  std::vector<float> m_errors; ///< by slot, or longer, like the next two: estimated error of each
                               ///< leaf; 0 where there is a node
  std::vector<LeafWeight> m_leaf_weights;
  std::vector<std::uint64_t> m_occluders;
  LeafSums m_sums;
  bool m_masked = false;                   ///< some leaf's visibility weight is below 1
  std::vector<std::uint32_t> m_candidates; ///< slots to test, and the query for them
  std::vector<Square> m_query;
  std::vector<SquareView> m_views;
};

AdaptiveProduct::Builder::Builder(const TreeView& light)
    : m_light(light), m_start(4 * inner_nodes) {
  m_product.m_remaining.resize(1);
  m_product.m_remaining[0].tree = light;
  ProductLeaf whole;
  whole.light = to_lanes(light.mean);
  whole.node = light.root();
  for (std::size_t node = 0; node < inner_nodes; ++node) // node i is the quadrant of slot i − 1
    split_light(light, node == 0 ? whole : m_start[node - 1], m_start.data() + 4 * node);
}

void AdaptiveProduct::Builder::set_shading_point(const RotatedReflectance& reflectance) {
  m_reflectance = reflectance;
  const Float4 mean = reflectance.pyramid->lookup(reflectance.theta_index0, 0, 0.5F, 0.5F);
  Float4& floor = m_product.m_remaining[0].floor;
  floor = larger(mean * reflectance_floor, Float4{});
  floor[3] = 0;
  const float light = lane_sum(to_lanes(m_light.mean) * luminance_lanes);
  const float reflected = lane_sum(mean * luminance_lanes);
  // Separate scales, because the product of the means may leave the range of float.
  const float scale = std::clamp(detail::density_scale(light) * detail::density_scale(reflected),
                                 0x1p-100F, 0x1p100F);
  m_product.m_remaining[0].weights = luminance_lanes * scale;
}

const ProductTree& AdaptiveProduct::Builder::build(const RotatedReflectance& reflectance,
                                                   const AdaptiveOptions& options,
                                                   SquareVisibility* visibility,
                                                   VisibilityTest test) {
  const bool all_squares = test == VisibilityTest::Squares;
  const Refinement refinement = {static_cast<double>(options.variance_bound),
                                 static_cast<std::size_t>(options.max_leaves),
                                 all_squares ? visibility : nullptr};
  set_shading_point(reflectance);
  start(refinement);
  refine(refinement);
  finish(options, all_squares ? nullptr : visibility);
  if (refinement.visibility != nullptr)
    m_reflectance.pyramid = nullptr;
  return m_product;
}

const ProductTree& AdaptiveProduct::Builder::reuse(const AdaptiveOptions& options,
                                                   SquareVisibility* visibility) {
  if (visibility == nullptr && !m_masked)
    return m_product;
  clear_leaf_visibility();
  return finish(options, visibility);
}

/// Tests leaves if there is a query, and sets the weights of inner squares.
const ProductTree& AdaptiveProduct::Builder::finish(const AdaptiveOptions& options,
                                                    SquareVisibility* visibility) {
  // A point in deep shadow has little light left to resolve: at most twice the leaves.
  const Refinement refinement = {
      static_cast<double>(options.variance_bound),
      std::min(static_cast<std::size_t>(options.max_leaves), 2 * m_product.leaf_count()), nullptr};
  for (int round = 0;
       visibility != nullptr && round < visibility_rounds && test_leaves(*visibility); ++round)
    refine(refinement);
  m_product.sum_upwards(m_parent_slots);
  return m_product;
}

/// Whether the last product can be used at another shading point.
bool AdaptiveProduct::Builder::is_reusable(const RotatedReflectance& reflectance,
                                           float reuse_variance_bound) const {
  if (m_reflectance.pyramid != reflectance.pyramid)
    return false;
  const float shift = squared_shift(reflectance.reflection, m_reflectance.reflection);
  return shift == 0 || (shift < detail::reuse_angle * detail::reuse_angle &&
                        drift_rate() * shift < reuse_variance_bound);
}

/// Relative variance that a rotation of the reflectance by one radian would add, extrapolated from
/// small rotations: squares change by their slopes over the angle of their side, half of it squared
/// in the mean of all directions (METHOD.md, section 7).
float AdaptiveProduct::Builder::drift_rate() const {
  return static_cast<float>(m_sums.drift / (m_sums.weight + 1e-30)) / (2 * sphere_area);
}

/// Appends a node whose weights are not set yet, in place of a leaf. @param slot −1 for the root
void AdaptiveProduct::Builder::new_node(std::int32_t slot, const Square& square) {
  const std::size_t index = m_product.m_nodes.size();
  m_product.m_nodes.emplace_back();
  m_squares.push_back(square);
  m_parent_slots.push_back(slot);
  if (slot >= 0)
    m_product.child(slot) = static_cast<std::int32_t>(index);
  if (m_errors.size() < 4 * m_product.m_nodes.size()) {
    m_product.m_leaves.resize(8 * index + 4);
    m_errors.resize(8 * index + 4);
    m_leaf_weights.resize(8 * index + 4);
  }
}

/// Makes a node of a slot.
void AdaptiveProduct::Builder::split(std::uint32_t slot) {
  m_errors[slot] = 0;
  m_leaf_weights[slot] = {};
  new_node(static_cast<std::int32_t>(slot), square(slot));
}

/// Builds the nodes above start_level and evaluates all squares there.
void AdaptiveProduct::Builder::start(const Refinement& refinement) {
  m_product.m_nodes.clear();
  m_squares.clear();
  m_parent_slots.clear();
  m_masked = false;
  m_sums = {};
  new_node(-1, {});
  for (std::uint32_t slot = 0; m_product.m_nodes.size() < start_nodes; ++slot)
    split(slot);
  std::ranges::copy(m_start, m_product.m_leaves.begin());
  expand(inner_nodes, std::numeric_limits<float>::infinity(), refinement);
}

/// In passes, splits the squares of the largest errors, and their quadrants with them, until the
/// bound holds.
void AdaptiveProduct::Builder::refine(const Refinement& refinement) {
  std::size_t before = 0;
  while (m_product.leaf_count() != before) {
    const double excess = m_sums.error - refinement.variance_bound * m_sums.weight;
    if (!(excess > 0))
      return;
    before = m_product.leaf_count();
    split_above(split_threshold(excess), refinement);
  }
}

/// Error above which squares are split: the mean, or more if splitting the squares above that
/// removes the excess.
float AdaptiveProduct::Builder::split_threshold(double excess) const {
  const auto mean =
      static_cast<float>(0.999 * m_sums.error / static_cast<double>(m_product.leaf_count()));
  std::array<float, 32> error_above = {}; // by half octaves of error over the mean
  for (const float error : std::span(m_errors).first(slot_count()))
    if (error > mean)
      error_above[half_octave(error / mean)] += error;
  double gain = 0;
  std::size_t bin = error_above.size();
  while (bin > 0 && gain < excess)
    gain += gain_of_splitting * static_cast<double>(error_above[--bin]);
  return bin == 0 ? mean : mean * half_octave_start(bin);
}

void AdaptiveProduct::Builder::split_above(float threshold, const Refinement& refinement) {
  const std::size_t first = m_product.m_nodes.size();
  for (std::uint32_t slot = 0; slot < 4 * first; ++slot)
    if (m_errors[slot] > threshold && has_room(refinement)) {
      const Slope& slope = m_product.m_leaves[slot].slope;
      m_sums.error -= static_cast<double>(m_errors[slot]);
      m_sums.weight -=
          static_cast<double>(m_product.weight_at(static_cast<std::int32_t>(slot)) * area(slot));
      m_sums.drift -= static_cast<double>(m_leaf_weights[slot].density *
                                          (slope.x * slope.x + slope.y * slope.y));
      split(slot);
    }
  expand(first, threshold, refinement);
}

/// Evaluates the quadrants of the nodes from `node` on. Those above the threshold become nodes,
/// which are appended and evaluated too; the others become leaves.
void AdaptiveProduct::Builder::expand(std::size_t node, float threshold,
                                      const Refinement& refinement) {
  std::array<detail::Quadrants, detail::square_batch> quadrants;
  while (node < m_product.m_nodes.size()) {
    const std::size_t count = std::min(quadrants.size(), m_product.m_nodes.size() - node);
    for (std::size_t i = 0; i < count; ++i) {
      const auto parent = static_cast<std::size_t>(m_parent_slots[node + i]);
      ProductLeaf* leaves = m_product.m_leaves.data() + 4 * (node + i);
      split_light(m_light, m_product.m_leaves[parent], leaves);
      for (std::size_t q = 0; q < 4; ++q)
        quadrants[i].light[q] = leaves[q].light;
    }
    detail::evaluate_quadrants(m_reflectance, m_product.m_remaining[0].floor,
                               m_product.m_remaining[0].weights,
                               std::span(m_squares).subspan(node, count), quadrants.data());
    if (refinement.visibility != nullptr)
      test_quadrants(node, std::span(quadrants).first(count), *refinement.visibility);
    for (std::size_t i = 0; i < count; ++i)
      add_leaves(node + i, quadrants[i], threshold, refinement);
    node += count;
  }
}

void AdaptiveProduct::Builder::add_leaves(std::size_t node, const detail::Quadrants& quadrants,
                                          float threshold, const Refinement& refinement) {
  m_product.m_nodes[node].weights = quadrants.density;
  for (unsigned q = 0; q < 4; ++q) {
    const auto slot = static_cast<std::uint32_t>(4 * node + q);
    if (quadrants.error[q] > threshold && has_room(refinement)) {
      split(slot);
      continue;
    }
    m_product.m_nodes[node].child[q] = ~static_cast<std::int32_t>(slot);
    set_leaf(slot, quadrants, q);
  }
}

/// Sets a leaf and adds it to the sums.
void AdaptiveProduct::Builder::set_leaf(std::uint32_t slot, const detail::Quadrants& quadrants,
                                        std::size_t q) {
  ProductLeaf& leaf = m_product.m_leaves[slot];
  leaf.square = square(slot);
  leaf.reflectance = quadrants.reflectance[q];
  leaf.slope = {quadrants.slope_x[q], quadrants.slope_y[q]};
  m_leaf_weights[slot] = {quadrants.density[q]};
  m_errors[slot] = quadrants.error[q];
  m_sums.error += static_cast<double>(quadrants.error[q]);
  m_sums.weight += static_cast<double>(quadrants.density[q] * area(slot));
  m_sums.drift += static_cast<double>(quadrants.drift[q]);
}

/// VisibilityTest::Leaves: tests the leaves of weight that are not tested yet.
/// @return whether any is hidden, in part or whole
bool AdaptiveProduct::Builder::test_leaves(SquareVisibility& visibility) {
  m_candidates.clear();
  m_query.clear();
  const auto least = static_cast<float>(smallest_tested_fraction * m_sums.weight);
  for (std::uint32_t slot = 0; slot < slot_count(); ++slot) {
    if (m_leaf_weights[slot].tested || !(m_leaf_weights[slot].density * area(slot) > least))
      continue;
    m_candidates.push_back(slot);
    m_query.push_back(square(slot));
  }
  m_views.assign(m_query.size(), {});
  visibility.query_visibility(m_query, m_views);
  bool any = false;
  for (std::size_t i = 0; i < m_candidates.size(); ++i) {
    m_leaf_weights[m_candidates[i]].tested = true;
    if (!(m_views[i].seen < 1))
      continue;
    set_leaf_visibility(m_candidates[i], std::max(least_weight_of_hidden_leaf, m_views[i].seen));
    any = true;
  }
  m_masked = m_masked || any;
  return any;
}

/// @param weight of a leaf whose visibility weight is 1
void AdaptiveProduct::Builder::set_leaf_visibility(std::uint32_t slot, float weight) {
  LeafWeight& leaf = m_leaf_weights[slot];
  const auto lost = static_cast<double>(1 - weight);
  leaf.visibility_weight = weight;
  m_sums.weight -= lost * static_cast<double>(leaf.density * area(slot));
  m_sums.error -= lost * static_cast<double>(m_errors[slot]);
  m_errors[slot] *= weight;
  m_product.weight_at(static_cast<std::int32_t>(slot)) = weight * leaf.density;
}

/// Resets all visibility weights to 1.
void AdaptiveProduct::Builder::clear_leaf_visibility() {
  m_sums.weight = 0;
  m_sums.error = 0;
  for (std::uint32_t slot = 0; slot < slot_count(); ++slot) {
    if (!is_leaf(slot))
      continue;
    LeafWeight& leaf = m_leaf_weights[slot];
    m_errors[slot] /= leaf.visibility_weight;
    leaf = {leaf.density};
    m_product.weight_at(static_cast<std::int32_t>(slot)) = leaf.density;
    m_sums.weight += static_cast<double>(leaf.density * area(slot));
    m_sums.error += static_cast<double>(m_errors[slot]);
  }
  m_masked = false;
}

/// VisibilityTest::Squares: weights the quadrants of nodes from `first` on. With the fraction c of
/// a square visible, its weight w counts as w √c in the second moment: variance is least for a
/// density in proportion to that, and 2 w (√c − c) is what resolving the boundary would remove
/// (METHOD.md, section 8).
void AdaptiveProduct::Builder::test_quadrants(std::size_t first,
                                              std::span<detail::Quadrants> quadrants,
                                              SquareVisibility& visibility) {
  m_candidates.clear();
  m_query.clear();
  m_views.clear();
  m_occluders.resize(m_errors.size(), SquareView{}.occluders);
  for (std::size_t i = 0; i < quadrants.size(); ++i) {
    const std::uint64_t occluders =
        m_occluders[static_cast<std::size_t>(m_parent_slots[first + i])];
    for (unsigned q = 0; q < 4; ++q) {
      const auto slot = static_cast<std::uint32_t>(4 * (first + i) + q);
      m_occluders[slot] = occluders;
      if (occluders == 0 || !(quadrants[i].density[q] > 0))
        continue;
      m_candidates.push_back(slot);
      m_query.push_back(square(slot));
      m_views.push_back({1, occluders});
    }
  }
  visibility.query_visibility(m_query, m_views);
  for (std::size_t i = 0; i < m_candidates.size(); ++i) {
    const std::uint32_t slot = m_candidates[i];
    const unsigned q = slot & 3U;
    const float seen = m_views[i].seen;
    detail::Quadrants& own = quadrants[slot / 4 - first];
    const float weight = own.density[q] * area(slot);
    const float visibility_weight = std::max(least_visibility_weight, std::sqrt(seen));
    m_occluders[slot] = m_views[i].occluders;
    own.density[q] *= visibility_weight;
    own.error[q] *= visibility_weight;
    if (seen > 0 && m_query[i].level < m_reflectance.pyramid->levels())
      own.error[q] += 2 * (visibility_weight - seen) * weight;
  }
}

AdaptiveProduct::AdaptiveProduct(const TreeView& light)
    : m_builder(std::make_unique<Builder>(light)) {}

AdaptiveProduct::~AdaptiveProduct() = default;

const ProductTree& AdaptiveProduct::build(const RotatedReflectance& reflectance,
                                          const AdaptiveOptions& options,
                                          SquareVisibility* visibility, VisibilityTest test) {
  return m_builder->build(reflectance, options, visibility, test);
}

const ProductTree& AdaptiveProduct::build_or_reuse(const RotatedReflectance& reflectance,
                                                   const AdaptiveOptions& options,
                                                   SquareVisibility* visibility) {
  if (m_builder->is_reusable(reflectance, options.reuse_variance_bound))
    return m_builder->reuse(options, visibility);
  return m_builder->build(reflectance, options, visibility, VisibilityTest::Leaves);
}

} // namespace haarlight::wavelet
