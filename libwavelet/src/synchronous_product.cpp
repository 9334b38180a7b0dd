#include <wavelet/synchronous_product.h>

#include <algorithm>
#include <cassert>

namespace haarlight::wavelet {
namespace {

/// In the density, the product of all factors but one counts as at least this share of its mean:
/// thresholding may have lost what a square once held.
constexpr float product_floor = 0.005F;

bool vanishes(Float4 mean) { return mean[0] == 0 && mean[1] == 0 && mean[2] == 0; }

} // namespace

void SynchronousProduct::Frontier::clear(std::size_t factors) {
  places.clear();
  means.resize(factors);
  details.resize(factors);
  for (std::size_t f = 0; f < factors; ++f) {
    means[f].clear();
    details[f].clear();
  }
}

const ProductTree& SynchronousProduct::build(std::span<const Factor* const> factors,
                                             int finest_level) {
  assert(!factors.empty() && finest_level >= 1 && finest_level <= 30);
  m_factors = factors;
  m_finest_level = finest_level;
  m_product.m_nodes.clear();
  m_product.m_leaves.clear();
  m_parent_slots.clear();
  m_quadrant_means.resize(factors.size(), std::vector<Float4>(4 * run));
  m_quadrant_details.resize(factors.size(), std::vector<std::uint32_t>(4 * run));
  choose_floors();
  start();
  while (!m_now.places.empty()) {
    m_next.clear(factors.size());
    for (std::size_t begin = 0; begin < m_now.places.size(); begin += run)
      split_run(begin, std::min(run, m_now.places.size() - begin));
    m_first_node += static_cast<std::int32_t>(m_now.places.size());
    std::swap(m_now, m_next);
  }
  m_product.m_leaf_count = m_product.m_leaves.size();
  m_product.sum_upwards(m_parent_slots);
  return m_product;
}

void SynchronousProduct::choose_floors() {
  m_product.m_rests.resize(m_factors.size());
  for (std::size_t rest = 0; rest < m_factors.size(); ++rest) {
    Float4 others = {1, 1, 1, 0};
    for (std::size_t f = 0; f < m_factors.size(); ++f)
      if (f != rest)
        others *= absolute(m_factors[f]->mean());
    const TreeView* tree = m_factors[rest]->tree();
    m_product.m_rests[rest] = {tree != nullptr ? *tree : TreeView{}, others * product_floor};
  }
}

/// The root is always a node, even if nothing has detail.
void SynchronousProduct::start() {
  m_first_node = 0;
  m_now.clear(m_factors.size());
  m_now.places.push_back({});
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    m_now.means[f].push_back(m_factors[f]->mean());
    m_now.details[f].push_back(m_factors[f]->root());
  }
  m_product.m_nodes.emplace_back();
  m_parent_slots.push_back(-1);
}

void SynchronousProduct::split_run(std::size_t begin, std::size_t count) {
  for (std::size_t f = 0; f < m_factors.size(); ++f)
    m_factors[f]->split({m_now.places.data() + begin, m_now.means[f].data() + begin,
                         m_now.details[f].data() + begin, count},
                        {m_quadrant_means[f].data(), m_quadrant_details[f].data()});
  for (std::size_t i = 0; i < count; ++i)
    if (m_factors.size() == 2)
      combine<2>(begin + i, i);
    else
      combine<0>(begin + i, i);
}

/// Makes a node or a leaf of each quadrant of a square. @tparam Factors how many, or 0: any number
template <std::size_t Factors>
void SynchronousProduct::combine(std::size_t square, std::size_t index_in_run) {
  const std::size_t factors = Factors > 0 ? Factors : m_factors.size();
  const SquarePlace& place = m_now.places[square];
  const std::int32_t node = m_first_node + static_cast<std::int32_t>(square);
  for (unsigned q = 0; q < 4; ++q) {
    const std::size_t quadrant = 4 * index_in_run + q;
    std::size_t detailed = 0;
    std::size_t rest = 0;
    bool zero = false;
    for (std::size_t f = 0; f < factors; ++f) {
      const bool constant = m_quadrant_details[f][quadrant] == no_node;
      zero = zero || (constant && vanishes(m_quadrant_means[f][quadrant]));
      detailed += constant ? 0 : 1;
      rest = constant ? rest : f;
    }
    const bool ends = detailed == 0 || (detailed == 1 && m_factors[rest]->tree() != nullptr);
    const std::int32_t slot = 4 * node + static_cast<std::int32_t>(q);
    if (!ends && !zero && place.level + 1 < m_finest_level)
      add_node({place.level + 1, 2 * place.column + (q & 1U), 2 * place.row + (q >> 1U)}, slot,
               quadrant);
    else
      add_leaf(place.level + 1, slot, quadrant, rest, !ends);
  }
}

void SynchronousProduct::add_node(const SquarePlace& place, std::int32_t slot,
                                  std::size_t quadrant) {
  m_next.places.push_back(place);
  for (std::size_t f = 0; f < m_factors.size(); ++f) {
    m_next.means[f].push_back(m_quadrant_means[f][quadrant]);
    m_next.details[f].push_back(m_quadrant_details[f][quadrant]);
  }
  m_product.child(slot) = static_cast<std::int32_t>(m_product.m_nodes.size());
  m_product.m_nodes.emplace_back();
  m_parent_slots.push_back(slot);
}

/// @param rest the factor that may have detail left
/// @param cut  whether more than that is left, and is given up
void SynchronousProduct::add_leaf(std::int32_t level, std::int32_t slot, std::size_t quadrant,
                                  std::size_t rest, bool cut) {
  ProductLeaf& leaf = m_product.m_leaves.emplace_back();
  leaf.light = m_quadrant_means[rest][quadrant];
  leaf.reflectance = Float4{1, 1, 1, 0};
  for (std::size_t f = 0; f < m_factors.size(); ++f)
    if (f != rest)
      leaf.reflectance *= m_quadrant_means[f][quadrant];
  leaf.node = cut ? no_node : m_quadrant_details[rest][quadrant];
  leaf.slot = slot;
  leaf.level = level;
  leaf.rest = static_cast<std::uint32_t>(rest);
  const auto place = static_cast<std::int32_t>(m_product.m_leaves.size() - 1);
  m_product.child(slot) = ~place;
  m_product.set_density(slot, std::max(m_product.density(place).mean, 0.0F));
}

} // namespace haarlight::wavelet
