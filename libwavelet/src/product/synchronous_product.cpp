#include <wavelet/product/synchronous_product.h>

#include "product/synchronous_kernel.h"

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

const ProductTree& SynchronousProduct::build(std::span<const Factor* const> factors,
                                             int finest_level) {
  assert(!factors.empty() && factors.size() < 256 && finest_level >= 1 && finest_level <= 30);
  m_factors = factors;
  m_finest_level = finest_level;
  m_integral = Float4{};
  look_at_factors();
  start();
  std::size_t begin = 1;
  for (std::int32_t level = 2; begin < m_node_count; ++level) {
    const std::size_t end = m_node_count;
    make_room(begin, end);
    if (m_needs_places)
      find_places(begin, end);
    for (; begin < end; begin = std::min(begin + run, end))
      split(begin, std::min(begin + run, end), level);
  }
  for (ProductTree::Slots& slots : m_product.m_slots) {
    slots.means.resize(4 * m_node_count);
    slots.details.resize(4 * m_node_count);
  }
  m_product.m_nodes.resize(m_node_count);
  m_product.m_integral = to_rgb(m_integral);
  m_product.sum_upwards(m_parent_slots);
  return m_product;
}

void SynchronousProduct::look_at_factors() {
  m_product.m_rests.resize(m_factors.size());
  m_product.m_slots.resize(m_factors.size());
  m_views.resize(m_factors.size());
  m_needs_places = false;
  for (std::size_t rest = 0; rest < m_factors.size(); ++rest) {
    Float4 others = {1, 1, 1, 0};
    for (std::size_t f = 0; f < m_factors.size(); ++f)
      if (f != rest)
        others *= absolute(m_factors[f]->mean());
    const TreeView* tree = m_factors[rest]->tree();
    m_product.m_rests[rest] = {tree != nullptr ? *tree : TreeView{}, others * product_floor};
    m_views[rest] = {nullptr, nullptr, others * product_floor, tree != nullptr ? -1 : 0};
    m_needs_places = m_needs_places || m_factors[rest]->needs_places();
  }
}

/// For nodes and all that their quadrants may become.
void SynchronousProduct::make_room(std::size_t begin, std::size_t end) {
  grow(m_product.m_nodes, end);
  grow(m_parent_slots, end + 4 * (end - begin) + 4);
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    ProductTree::Slots& slots = m_product.m_slots[f];
    grow(slots.means, 4 * end);
    grow(slots.details, 4 * end);
    m_views[f].means = slots.means.data();
    m_views[f].details = slots.details.data();
  }
}

/// The root is always a node, even if nothing has detail.
void SynchronousProduct::start() {
  make_room(0, 1);
  m_node_count = 1;
  grow(m_places, 1);
  m_places[0] = {};
  m_parent_slots[0] = 0;
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    const Float4 mean = m_factors[f]->mean();
    const std::uint32_t root = m_factors[f]->root();
    m_factors[f]->split({m_places.data(), m_parent_slots.data(), &mean, &root, 1},
                        {m_views[f].means, m_views[f].details});
  }
  finish(0, 1, 1);
}

/// @param level of the nodes' quadrants
void SynchronousProduct::split(std::size_t begin, std::size_t end, std::int32_t level) {
  for (std::size_t f = 0; f < m_factors.size(); ++f)
    m_factors[f]->split({m_needs_places ? m_places.data() + begin : nullptr,
                         m_parent_slots.data() + begin, m_views[f].means, m_views[f].details,
                         end - begin},
                        {m_views[f].means + 4 * begin, m_views[f].details + 4 * begin});
  finish(begin, end, level);
}

void SynchronousProduct::finish(std::size_t begin, std::size_t end, std::int32_t level) {
  detail::SplitSquares squares;
  squares.factors = m_views;
  squares.begin = begin;
  squares.end = end;
  squares.may_split = level < m_finest_level;
  squares.node_count = m_node_count;
  squares.nodes = m_product.m_nodes.data();
  squares.parent_slots = m_parent_slots.data();
  detail::finish(squares);
  m_node_count = squares.node_count;
  m_integral += squares.leaf_sum * power_of_two(-2 * level);
}

void SynchronousProduct::find_places(std::size_t begin, std::size_t end) {
  grow(m_places, end);
  for (std::size_t node = begin; node < end; ++node) {
    const auto slot = static_cast<std::uint32_t>(m_parent_slots[node]);
    const SquarePlace& parent = m_places[slot / 4];
    m_places[node] = {parent.level + 1, 2 * parent.column + (slot & 1U),
                      2 * parent.row + (slot >> 1U & 1U)};
  }
}

} // namespace haarlight::wavelet
