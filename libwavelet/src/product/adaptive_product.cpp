#include <wavelet/product/adaptive_product.h>

#include "product/product_kernel.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace haarlight::wavelet {
namespace {

/// Products are looked at down to this level before anything is decided.
constexpr int start_level = 3;

/// The reflectance counts as at least this share of its mean wherever light can come from, so that
/// no direction of the integrand is out of reach.
constexpr float reflectance_floor = 0.005F;

/// Share of a square's error that splitting it is taken to get rid of.
constexpr double gain_of_splitting = 0.6;

/// Half octaves between 1 and a ratio above it, 31 at most: the float's exponent and first digit.
std::size_t half_octave(float ratio) {
  return std::min((std::bit_cast<std::uint32_t>(ratio) >> 22U) - (127U << 1U), 31U);
}

/// The least ratio of a half octave, 1, 1.5, 2, 3, …
float half_octave_start(std::size_t index) {
  return std::bit_cast<float>((static_cast<std::uint32_t>(index) + (127U << 1U)) << 22U);
}

/// Nodes that every product has, those of fewer than start_level levels, and what part of them has
/// no leaves.
constexpr std::size_t nodes_above(int level) { return ((1ULL << (2 * level)) - 1) / 3; }
constexpr std::size_t start_nodes = nodes_above(start_level);
constexpr std::size_t inner_nodes = nodes_above(start_level - 1);

/// Average and node of a square's four quadrants in a tree, of which the square's are given.
void split_light(const TreeView& tree, const ProductLeaf& square, ProductLeaf* quadrants) {
  std::array<Float4, 4> means;
  means.fill(square.light);
  if (square.node != no_node)
    means = tree.details(square.node).children(square.light);
  for (unsigned q = 0; q < 4; ++q) {
    quadrants[q].light = means[q];
    quadrants[q].node = tree.child(square.node, q);
  }
}

} // namespace

AdaptiveProduct::AdaptiveProduct(const TreeView& light) : m_light(light), m_start(4 * inner_nodes) {
  m_product.m_rests.resize(1);
  m_product.m_rests[0].tree = light;
  ProductLeaf whole;
  whole.light = to_lanes(light.mean);
  whole.node = light.root();
  for (std::size_t node = 0; node < inner_nodes; ++node) // node i is the quadrant of slot i − 1
    split_light(light, node == 0 ? whole : m_start[node - 1], m_start.data() + 4 * node);
}

void AdaptiveProduct::turn_to(const RotatedReflectance& reflectance,
                              const AdaptiveOptions& options) {
  m_reflectance = reflectance;
  m_limit = static_cast<std::size_t>(options.max_leaves);
  const Float4 mean = reflectance.pyramid->lookup(reflectance.entry0, 0, 0.5F, 0.5F);
  Float4& floor = m_product.m_rests[0].floor;
  floor = larger(mean * reflectance_floor, Float4{});
  floor[3] = 0;
  const float light = lane_sum(to_lanes(m_light.mean) * luminance_lanes);
  const float reflected = lane_sum(mean * luminance_lanes);
  // Apart, for the product of the means may leave the range of float.
  const float scale = std::clamp(detail::density_scale(light) * detail::density_scale(reflected),
                                 0x1p-100F, 0x1p100F);
  m_product.m_rests[0].weights = luminance_lanes * scale;
}

const ProductTree& AdaptiveProduct::build(const RotatedReflectance& reflectance,
                                          const AdaptiveOptions& options,
                                          const Occlusion* occlusion) {
  turn_to(reflectance, options);
  start();
  refine(options);
  return finish(options, occlusion);
}

const ProductTree& AdaptiveProduct::build(const RotatedReflectance& reflectance,
                                          const AdaptiveOptions& options,
                                          SquareVisibility& visibility) {
  m_visibility = &visibility;
  build(reflectance, options);
  m_visibility = nullptr;
  m_reflectance.pyramid = nullptr; // follow() has no product to keep
  return m_product;
}

const ProductTree& AdaptiveProduct::follow(const RotatedReflectance& reflectance,
                                           const AdaptiveOptions& options,
                                           const Occlusion* occlusion) {
  if (!serves(reflectance, options.drift_bound))
    return build(reflectance, options, occlusion);
  if (occlusion == nullptr && !m_masked)
    return m_product;
  unmask();
  return finish(options, occlusion);
}

const ProductTree& AdaptiveProduct::finish(const AdaptiveOptions& options,
                                           const Occlusion* occlusion) {
  if (occlusion != nullptr)
    mask(options, *occlusion);
  m_product.sum_upwards(m_parent_slots);
  return m_product;
}

/// Error beyond the bound, by estimate; negative within.
double AdaptiveProduct::excess_error(const AdaptiveOptions& options) const {
  return m_error - static_cast<double>(options.variance_bound) * m_weight;
}

/// Whether the product at hand will do as it is, so far from where it was built.
bool AdaptiveProduct::serves(const RotatedReflectance& reflectance, float drift_bound) const {
  if (m_reflectance.pyramid != reflectance.pyramid)
    return false;
  const float shift = squared_shift(reflectance.reflection);
  return shift == 0 ||
         (shift < detail::kept_shift * detail::kept_shift && drift_rate() * shift < drift_bound);
}

/// Relative variance that a turn of the reflectance by one radian would add, were it to go on as it
/// begins: squares change by their slopes over the angle that their side spans, half of it squared
/// in the mean of all directions.
float AdaptiveProduct::drift_rate() const {
  return static_cast<float>(m_drift / (m_weight + 1e-30)) / (2 * sphere_area);
}

/// How far normal and mirror direction are from where the product was weighed: the sum of their
/// squared chords.
float AdaptiveProduct::squared_shift(const ReflectionFrame& reflection) const {
  const ReflectionFrame& old = m_reflectance.reflection;
  const auto normal = [](const ReflectionFrame& r) -> Vec3 {
    return r.sin_theta_r * r.frame.t + r.cos_theta_r * r.frame.n;
  };
  return (reflection.frame.n - old.frame.n).squaredNorm() +
         (normal(reflection) - normal(old)).squaredNorm();
}

/// A node whose weights are yet to come, in place of a leaf.
void AdaptiveProduct::new_node(std::int32_t slot, const SquarePlace& square) {
  const std::size_t index = m_product.m_nodes.size();
  m_product.m_nodes.emplace_back();
  m_squares.push_back(square);
  m_parent_slots.push_back(slot);
  if (slot >= 0)
    m_product.child(slot) = static_cast<std::int32_t>(index);
  if (m_errors.size() < 4 * m_product.m_nodes.size()) {
    m_product.m_leaves.resize(8 * index + 4);
    m_errors.resize(8 * index + 4);
    m_shares.resize(8 * index + 4);
  }
}

/// Makes a node of what is no leaf any more, or never was one.
void AdaptiveProduct::split(std::uint32_t slot) {
  m_errors[slot] = 0;
  m_shares[slot] = {};
  new_node(static_cast<std::int32_t>(slot), square(slot));
}

/// Lays out the nodes above start_level and looks at every square there.
void AdaptiveProduct::start() {
  m_product.m_nodes.clear();
  m_squares.clear();
  m_parent_slots.clear();
  m_masked = false;
  m_weight = 0;
  m_error = 0;
  m_drift = 0;
  new_node(-1, {});
  for (std::uint32_t slot = 0; m_product.m_nodes.size() < start_nodes; ++slot)
    split(slot);
  std::ranges::copy(m_start, m_product.m_leaves.begin());
  expand(inner_nodes, std::numeric_limits<float>::infinity());
}

/// Pass by pass, splits the squares that leave the most error, and their quadrants with them, until
/// the bound holds.
void AdaptiveProduct::refine(const AdaptiveOptions& options) {
  std::size_t before = 0;
  while (m_product.leaf_count() != before) {
    const double excess = excess_error(options);
    if (!(excess > 0))
      return;
    before = m_product.leaf_count();
    split_above(threshold(excess));
  }
}

/// Error above which squares are to be split: the mean, or more if splitting the squares above that
/// gets rid of the excess.
float AdaptiveProduct::threshold(double excess) const {
  const auto mean =
      static_cast<float>(0.999 * m_error / static_cast<double>(m_product.leaf_count()));
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

void AdaptiveProduct::split_above(float threshold) {
  const std::size_t first = m_product.m_nodes.size();
  for (std::uint32_t slot = 0; slot < 4 * first; ++slot)
    if (m_errors[slot] > threshold && has_room()) {
      m_error -= static_cast<double>(m_errors[slot]);
      m_weight -=
          static_cast<double>(m_product.weight_at(static_cast<std::int32_t>(slot)) * area(slot));
      m_drift -= drift_of(slot);
      split(slot);
    }
  expand(first, threshold);
}

/// Gives the nodes from `node` on their leaves, and those of them above the threshold nodes of
/// their own, which follow.
void AdaptiveProduct::expand(std::size_t node, float threshold) {
  std::array<detail::Quadrants, detail::square_batch> quadrants;
  while (node < m_product.m_nodes.size()) {
    const std::size_t count = std::min(quadrants.size(), m_product.m_nodes.size() - node);
    for (std::size_t i = 0; i < count; ++i)
      see_light(node + i, quadrants[i]);
    detail::weigh(m_reflectance, m_product.m_rests[0].floor, m_product.m_rests[0].weights,
                  std::span(m_squares).subspan(node, count), quadrants.data());
    if (m_visibility != nullptr)
      look(node, std::span(quadrants).first(count));
    for (std::size_t i = 0; i < count; ++i)
      add_leaves(node + i, quadrants[i], threshold);
    node += count;
  }
}

void AdaptiveProduct::see_light(std::size_t node, detail::Quadrants& quadrants) {
  const auto parent = static_cast<std::size_t>(m_parent_slots[node]);
  ProductLeaf* leaves = m_product.m_leaves.data() + 4 * node;
  split_light(m_light, m_product.m_leaves[parent], leaves);
  for (std::size_t q = 0; q < 4; ++q)
    quadrants.light[q] = leaves[q].light;
}

void AdaptiveProduct::add_leaves(std::size_t node, const detail::Quadrants& quadrants,
                                 float threshold) {
  m_product.m_nodes[node].weights = quadrants.density;
  for (unsigned q = 0; q < 4; ++q) {
    const auto slot = static_cast<std::uint32_t>(4 * node + q);
    if (quadrants.error[q] > threshold && has_room()) {
      split(slot);
      continue;
    }
    m_product.m_nodes[node].child[q] = ~static_cast<std::int32_t>(slot);
    set_leaf(slot, quadrants, q);
  }
}

/// A leaf's numbers, and its part in the sums.
void AdaptiveProduct::set_leaf(std::uint32_t slot, const detail::Quadrants& quadrants,
                               std::size_t q) {
  ProductLeaf& leaf = m_product.m_leaves[slot];
  const SquarePlace place = square(slot);
  leaf.x = static_cast<std::uint16_t>(place.column);
  leaf.y = static_cast<std::uint16_t>(place.row);
  leaf.level = static_cast<std::uint8_t>(place.level);
  leaf.reflectance = quadrants.reflectance[q];
  leaf.slope = {quadrants.slope_x[q], quadrants.slope_y[q]};
  m_shares[slot] = {quadrants.density[q]};
  m_errors[slot] = quadrants.error[q];
  m_error += static_cast<double>(quadrants.error[q]);
  m_weight += static_cast<double>(quadrants.density[q] * area(slot));
  m_drift += static_cast<double>(quadrants.drift[q]);
}

/// What a leaf adds to the weight times the drift rate, in squares of the unit square's side.
double AdaptiveProduct::drift_of(std::uint32_t slot) const {
  const Slope& slope = m_product.m_leaves[slot].slope;
  return static_cast<double>(m_shares[slot].density * (slope.x * slope.x + slope.y * slope.y));
}

} // namespace haarlight::wavelet
