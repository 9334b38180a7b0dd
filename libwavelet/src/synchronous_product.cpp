#include <wavelet/synchronous_product.h>

#include "synchronous_kernel.h"

#include <algorithm>
#include <cassert>

namespace haarlight::wavelet {
namespace {

/// In the density, the product of all factors but one counts as at least this share of its mean:
/// thresholding may have lost what a square once held.
constexpr float product_floor = 0.005F;

template <class T>
void grow(std::vector<T>& array, std::size_t size) {
  if (array.size() < size)
    array.resize(size);
}

} // namespace

void SynchronousProduct::Frontier::make_room(std::size_t factors, std::size_t squares) {
  grow(places, squares);
  grow(means, factors);
  grow(details, factors);
  for (std::size_t f = 0; f < factors; ++f) {
    grow(means[f], squares);
    grow(details[f], squares);
  }
}

const ProductTree& SynchronousProduct::build(std::span<const Factor* const> factors,
                                             int finest_level) {
  assert(!factors.empty() && factors.size() < 256 && finest_level >= 1 && finest_level <= 30);
  m_factors = factors;
  m_finest_level = finest_level;
  look_at_factors();
  start();
  Float4 integral = {};
  for (std::int32_t level = 1; m_now.count > 0; ++level)
    integral += split_level(level) * power_of_two(-2 * level);
  m_product.m_nodes.resize(static_cast<std::size_t>(m_first_node));
  m_product.m_leaves.resize(m_leaf_count);
  m_product.m_leaf_count = m_leaf_count;
  m_product.m_integral = to_rgb(integral);
  m_product.sum_upwards(m_parent_slots);
  return m_product;
}

void SynchronousProduct::look_at_factors() {
  m_product.m_rests.resize(m_factors.size());
  m_views.resize(m_factors.size());
  grow(m_quadrant_means, m_factors.size());
  grow(m_quadrant_details, m_factors.size());
  m_needs_places = false;
  for (std::size_t rest = 0; rest < m_factors.size(); ++rest) {
    Float4 others = {1, 1, 1, 0};
    for (std::size_t f = 0; f < m_factors.size(); ++f)
      if (f != rest)
        others *= absolute(m_factors[f]->mean());
    grow(m_quadrant_means[rest], 4 * detail::square_run);
    grow(m_quadrant_details[rest], 4 * detail::square_run);
    const TreeView* tree = m_factors[rest]->tree();
    m_product.m_rests[rest] = {tree != nullptr ? *tree : TreeView{}, others * product_floor};
    m_views[rest] = {m_quadrant_means[rest].data(), m_quadrant_details[rest].data(),
                     others * product_floor, tree != nullptr ? -1 : 0};
    m_needs_places = m_needs_places || m_factors[rest]->needs_places();
  }
}

/// The root is always a node, even if nothing has detail.
void SynchronousProduct::start() {
  m_first_node = 0;
  m_leaf_count = 0;
  m_now.make_room(m_factors.size(), 1);
  m_now.count = 1;
  m_now.places[0] = {};
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    m_now.means[f][0] = m_factors[f]->mean();
    m_now.details[f][0] = m_factors[f]->root();
  }
  grow(m_parent_slots, 1);
  m_parent_slots[0] = -1;
}

/// Splits all squares at hand; those of their quadrants that want splitting take their place.
/// @param level of the quadrants
/// @return Σ of the new leaves' products
Float4 SynchronousProduct::split_level(std::int32_t level) {
  grow(m_product.m_nodes, static_cast<std::size_t>(m_first_node) + m_now.count);
  m_next.count = 0;
  detail::ProductRun run;
  run.factors = m_views;
  run.level = level;
  run.splits = level < m_finest_level;
  Float4 sum = {};
  for (std::size_t begin = 0; begin < m_now.count; begin += detail::square_run) {
    run.squares = std::min(detail::square_run, m_now.count - begin);
    split_run(begin, run);
    sum += run.leaf_sum;
  }
  m_first_node += static_cast<std::int32_t>(m_now.count);
  std::swap(m_now, m_next);
  return sum;
}

void SynchronousProduct::split_run(std::size_t begin, detail::ProductRun& run) {
  const std::size_t node = static_cast<std::size_t>(m_first_node) + begin;
  grow(m_product.m_leaves, m_leaf_count + 4 * run.squares);
  run.first_node = static_cast<std::int32_t>(node);
  run.next_node = m_first_node + static_cast<std::int32_t>(m_now.count + m_next.count);
  run.next_leaf = static_cast<std::int32_t>(m_leaf_count);
  run.nodes = m_product.m_nodes.data() + node;
  run.leaves = m_product.m_leaves.data() + m_leaf_count;
  for (std::size_t f = 0; f < m_factors.size(); ++f)
    m_factors[f]->split({m_now.places.data() + begin, m_now.means[f].data() + begin,
                         m_now.details[f].data() + begin, run.squares},
                        {m_views[f].means, m_views[f].details});
  detail::finish_run(run);
  m_leaf_count += run.leaf_count;
  queue(run);
  if (m_needs_places)
    queue_places(begin, run);
  m_next.count += run.split_count;
}

/// Puts a run's quadrants that want splitting among the next level's squares.
void SynchronousProduct::queue(const detail::ProductRun& run) {
  const std::size_t end = m_next.count + run.split_count;
  m_next.make_room(m_factors.size(), end);
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    Float4* const means = m_next.means[f].data() + m_next.count;
    std::uint32_t* const details = m_next.details[f].data() + m_next.count;
    for (std::size_t i = 0; i < run.split_count; ++i) {
      const auto quadrant = static_cast<std::size_t>(run.split_quadrants[i]);
      means[i] = m_views[f].means[quadrant];
      details[i] = m_views[f].details[quadrant];
    }
  }
  grow(m_parent_slots, static_cast<std::size_t>(run.next_node) + run.split_count);
  std::int32_t* const slots = m_parent_slots.data() + run.next_node;
  for (std::size_t i = 0; i < run.split_count; ++i)
    slots[i] = 4 * run.first_node + run.split_quadrants[i];
}

void SynchronousProduct::queue_places(std::size_t begin, const detail::ProductRun& run) {
  for (std::size_t i = 0; i < run.split_count; ++i) {
    const auto quadrant = static_cast<std::uint32_t>(run.split_quadrants[i]);
    const SquarePlace& parent = m_now.places[begin + quadrant / 4];
    m_next.places[m_next.count + i] = {parent.level + 1, 2 * parent.column + (quadrant & 1U),
                                       2 * parent.row + (quadrant >> 1U & 1U)};
  }
}

} // namespace haarlight::wavelet
