#include <wavelet/adaptive_product.h>

#include "product_kernel.h"

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

/// A cut that followed other points until it had this part more leaves than at first is given up.
constexpr std::size_t growth = 8;

/// Half octaves between 1 and a ratio above it, 31 at most: the float's exponent and first digit.
std::size_t half_octave(float ratio) {
  return std::min((std::bit_cast<std::uint32_t>(ratio) >> 22U) - (127U << 1U), 31U);
}

/// The least ratio of a half octave, 1, 1.5, 2, 3, …
float half_octave_start(std::size_t index) {
  return std::bit_cast<float>((static_cast<std::uint32_t>(index) + (127U << 1U)) << 22U);
}

std::uint16_t morton_column(unsigned code) {
  return static_cast<std::uint16_t>((code & 1U) | ((code >> 1U) & 2U) | ((code >> 2U) & 4U));
}

} // namespace

AdaptiveProduct::AdaptiveProduct(const TreeView& light) : m_light(light) {
  m_product.m_rests.resize(1);
  m_product.m_rests[0].tree = light;
  // The families of level start_level − 1 and the nodes above them are the same for every product.
  for (unsigned code = 0; code < (1U << (2 * (start_level - 1))); ++code) {
    Family family = {to_lanes(light.mean), light.root(),        0,
                     start_level - 1,      morton_column(code), morton_column(code >> 1U)};
    for (int l = start_level - 2; l >= 0; --l) {
      const unsigned q = (code >> static_cast<unsigned>(2 * l)) & 3U;
      if (family.node != no_node)
        family.light = light.details(family.node).children(family.light)[q];
      family.node = light.child(family.node, q);
    }
    m_start.push_back(family);
  }
}

void AdaptiveProduct::turn_to(const RotatedReflectance& reflectance,
                              const AdaptiveOptions& options) {
  m_reflectance = reflectance;
  m_limit = static_cast<std::size_t>(options.max_leaves);
  const Float4 mean = reflectance.pyramid->lookup(reflectance.entry0, 0, 0.5F, 0.5F);
  Float4& floor = m_product.m_rests[0].floor;
  floor = larger(mean * reflectance_floor, Float4{});
  floor[3] = 0;
}

const ProductTree& AdaptiveProduct::build(const RotatedReflectance& reflectance,
                                          const AdaptiveOptions& options,
                                          const Occlusion* occlusion) {
  if (m_reflectance.pyramid != reflectance.pyramid)
    m_drift_rate = -1;
  turn_to(reflectance, options);
  start();
  refine(options);
  m_fresh_leaves = m_product.m_leaf_count;
  return finish(options, occlusion);
}

const ProductTree& AdaptiveProduct::follow(const RotatedReflectance& reflectance,
                                           const AdaptiveOptions& options,
                                           const Occlusion* occlusion) {
  if (m_reflectance.pyramid != reflectance.pyramid ||
      m_product.m_leaf_count > m_fresh_leaves + m_fresh_leaves / growth)
    return build(reflectance, options, occlusion);
  const float shift = squared_shift(reflectance.reflection);
  if (serves(shift, options.drift_bound)) {
    if (occlusion == nullptr && !m_masked)
      return m_product;
    unmask();
    return finish(options, occlusion);
  }
  turn_to(reflectance, options);
  const float drift = weigh_again();
  m_drift_rate = shift > 0 ? drift / shift : m_drift_rate;
  refine(options);
  // With no leaves to spare, the old squares would stand in the way of those that matter now.
  if (excess_error(options) > 0 && m_product.m_leaf_count + 3 > m_limit)
    return build(reflectance, options, occlusion);
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

/// Whether the product at hand will do as it is, so far from where it was weighed.
bool AdaptiveProduct::serves(float squared_shift, float drift_bound) const {
  const bool is_near = squared_shift < detail::kept_shift * detail::kept_shift;
  const bool is_alike = m_drift_rate >= 0 && m_drift_rate * squared_shift < drift_bound;
  return squared_shift == 0 || (is_near && is_alike);
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

/// Keeps the squares of the product at hand, with the weights that they have now.
/// @return the relative variance that the old weights would have added: Σ new²/old − 1, both of
/// sum 1
float AdaptiveProduct::weigh_again() {
  const auto least = static_cast<float>(1e-6 * m_weight);
  double old_weight = 0;
  double squares = 0;
  std::array<float, 4 * detail::family_batch> density;
  const std::span<ProductLeaf> all = m_product.m_leaves;
  m_error = 0;
  m_weight = 0;
  m_masked = false;
  for (std::size_t begin = 0; begin < all.size(); begin += density.size()) {
    const auto batch = all.subspan(begin, std::min(density.size(), all.size() - begin));
    detail::weigh_leaves(m_reflectance, m_product.m_rests[0].floor, batch, density.data(),
                         m_errors.data() + begin);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      // Places not in use have a slot of old, but no light, and what stands there is summed anew.
      const auto slot = static_cast<std::uint32_t>(batch[i].slot);
      const float area = power_of_two(-2 * batch[i].level);
      const float old = m_shares[begin + i].density;
      old_weight += static_cast<double>(old * area);
      squares += static_cast<double>(area * density[i] * density[i] / (old + least));
      m_shares[begin + i] = {density[i]};
      m_product.m_nodes[slot / 4].weights[slot & 3U] = density[i];
      m_weight += static_cast<double>(density[i] * area);
      m_error += static_cast<double>(m_errors[begin + i]);
    }
  }
  return static_cast<float>(squares * old_weight / (m_weight * m_weight + 1e-30) - 1);
}

/// A node whose weights are yet to come.
std::int32_t AdaptiveProduct::new_node(std::int32_t slot) {
  m_product.m_nodes.emplace_back();
  m_parent_slots.push_back(slot);
  const auto index = static_cast<std::int32_t>(m_product.m_nodes.size() - 1);
  if (slot >= 0)
    m_product.child(slot) = index;
  return index;
}

/// Lays out the nodes above start_level and looks at every family there.
void AdaptiveProduct::start() {
  m_product.m_nodes.clear();
  m_product.m_leaves.clear();
  m_parent_slots.clear();
  m_errors.clear();
  m_shares.clear();
  m_masked = false;
  m_free.clear();
  m_weight = 0;
  m_error = 0;
  new_node(-1);
  for (std::int32_t parent = 0; m_product.m_nodes.size() < 1 + m_start.size() / 4 + m_start.size();
       ++parent)
    for (std::int32_t q = 0; q < 4; ++q)
      new_node(4 * parent + q);
  m_families = m_start;
  m_product.m_leaf_count = 4 * m_start.size();
  auto node = static_cast<std::int32_t>(m_product.m_nodes.size() - m_start.size());
  for (Family& family : m_families)
    family.product_node = node++;
  expand_all(std::numeric_limits<float>::infinity());
}

/// Pass by pass, splits the squares that leave the most error, and their quadrants with them, until
/// the bound holds.
void AdaptiveProduct::refine(const AdaptiveOptions& options) {
  std::size_t before = 0;
  while (m_product.m_leaf_count != before) {
    const double excess = excess_error(options);
    if (!(excess > 0))
      return;
    before = m_product.m_leaf_count;
    split_above(threshold(excess));
  }
}

/// Error above which squares are to be split: the mean, or more if splitting the squares above that
/// gets rid of the excess.
float AdaptiveProduct::threshold(double excess) const {
  const auto mean =
      static_cast<float>(0.999 * m_error / static_cast<double>(m_product.m_leaf_count));
  std::array<float, 32> error_above = {}; // by half octaves of error over the mean
  for (const float error : m_errors)
    if (error > mean)
      error_above[half_octave(error / mean)] += error;
  double gain = 0;
  std::size_t bin = error_above.size();
  while (bin > 0 && gain < excess)
    gain += gain_of_splitting * static_cast<double>(error_above[--bin]);
  return bin == 0 ? mean : mean * half_octave_start(bin);
}

void AdaptiveProduct::split_above(float threshold) {
  m_families.clear();
  for (std::size_t i = 0; i < m_errors.size(); ++i) {
    if (!(m_errors[i] > threshold) || m_product.m_leaf_count + 3 > m_limit)
      continue;
    ProductLeaf& leaf = m_product.m_leaves[i];
    m_error -= static_cast<double>(m_errors[i]);
    m_weight -= static_cast<double>(m_product.weight(leaf));
    split(leaf, m_families.emplace_back());
    m_free.push_back(static_cast<std::uint32_t>(i));
    leaf.light = Float4{};
    m_errors[i] = 0;
    m_shares[i] = {};
  }
  expand_all(threshold);
}

/// Replaces m_families by their quadrants, and those above the threshold by theirs.
void AdaptiveProduct::expand_all(float threshold) {
  std::array<detail::Quadrants, detail::family_batch> quadrants;
  for (; !m_families.empty(); m_families.swap(m_next)) {
    m_next.clear();
    for (std::size_t begin = 0; begin < m_families.size(); begin += detail::family_batch) {
      const auto batch =
          std::span<const Family>(m_families)
              .subspan(begin, std::min(detail::family_batch, m_families.size() - begin));
      detail::weigh_families(m_light, m_reflectance, m_product.m_rests[0].floor, batch,
                             quadrants.data());
      for (std::size_t i = 0; i < batch.size(); ++i)
        add(batch[i], quadrants[i], threshold);
    }
  }
}

/// Makes leaves of a family's visible quadrants, or families of those above the threshold.
void AdaptiveProduct::add(const Family& family, const detail::Quadrants& quadrants,
                          float threshold) {
  const std::int32_t level = family.level + 1;
  m_product.m_nodes[static_cast<std::size_t>(family.product_node)].weights = quadrants.density;
  m_product.m_leaf_count -= 4;
  double density = 0;
  for (unsigned q = 0; q < 4; ++q) {
    ++m_product.m_leaf_count;
    const bool splits = quadrants.error[q] > threshold && m_product.m_leaf_count + 3 <= m_limit;
    const std::uint32_t place = splits ? 0 : new_leaf();
    ProductLeaf& leaf = splits ? m_split : m_product.m_leaves[place];
    leaf.light = quadrants.light[q];
    leaf.reflectance = quadrants.reflectance[q];
    leaf.node = quadrants.children[q];
    leaf.slot = 4 * family.product_node + static_cast<std::int32_t>(q);
    leaf.level = static_cast<std::uint8_t>(level);
    leaf.x = static_cast<std::uint16_t>(2 * family.x + (q & 1U));
    leaf.y = static_cast<std::uint16_t>(2 * family.y + (q >> 1U));
    if (splits) {
      split(leaf, m_next.emplace_back());
      continue;
    }
    m_errors[place] = quadrants.error[q];
    m_shares[place] = {quadrants.density[q]};
    m_product.child(leaf.slot) = ~static_cast<std::int32_t>(place);
    m_error += static_cast<double>(quadrants.error[q]);
    density += static_cast<double>(quadrants.density[q]);
  }
  m_weight += density * static_cast<double>(power_of_two(-2 * level));
}

/// Makes a product node of a square, which counts as four leaves from now on.
void AdaptiveProduct::split(const ProductLeaf& square, Family& family) {
  m_product.m_leaf_count += 3;
  family.light = square.light;
  family.node = square.node;
  family.product_node = new_node(square.slot);
  family.level = square.level;
  family.x = square.x;
  family.y = square.y;
}

/// A place for a leaf.
std::uint32_t AdaptiveProduct::new_leaf() {
  if (m_free.empty()) {
    m_product.m_leaves.emplace_back();
    m_errors.push_back(0);
    m_shares.emplace_back();
    return static_cast<std::uint32_t>(m_errors.size() - 1);
  }
  const std::uint32_t place = m_free.back();
  m_free.pop_back();
  return place;
}

} // namespace haarlight::wavelet
