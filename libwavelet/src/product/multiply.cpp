#include <wavelet/product/multiply.h>

#include "tree/tree_writer.h"

#include <wavelet/product/synchronous_product.h>
#include <wavelet/transform/transform.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace haarlight::wavelet {
namespace {

std::vector<TreeFactor> factors_of(std::span<const TreeView> trees) {
  std::vector<TreeFactor> factors;
  for (const TreeView& tree : trees)
    factors.emplace_back(tree);
  return factors;
}

/// Turns a product into a tree: first all its nodes, breadth first, then those that are kept.
class ProductFlattener {
public:
  explicit ProductFlattener(const ProductTree& product) : m_product(product) {
    find_averages();
    m_items.push_back(product_item(0));
    for (std::size_t i = 0; i < m_items.size(); ++i)
      add_children(i);
  }

  Tree tree(int levels, int channels, const MultiplyOptions& options) {
    const double mean = static_cast<double>(luminance(m_mean));
    keep_above(static_cast<float>(options.tolerance * mean));
    Tree tree;
    tree.levels = levels;
    tree.channels = channels;
    tree.type = options.coefficients;
    tree.mean = m_mean;
    float top = 0;
    for (const Item& item : m_items)
      if (item.kept)
        top = std::max(top, largest_difference(item.details));
    tree.scale = coefficient_scale(tree.type, top);
    TreeWriter writer(tree);
    for (const Item& item : m_items)
      if (item.kept)
        writer.add(item.kept_children, item.details);
    writer.finish();
    return tree;
  }

private:
  /// A node of the tree to be written: of the product, or of a factor's tree times a constant.
  struct Item {
    std::int32_t product_node = -1;
    std::uint32_t node = no_node;
    std::uint32_t remaining = 0; ///< the factor
    Float4 scale = {};
    Details details = {};
    std::int32_t level = 0;
    std::uint32_t first_child = 0;
    std::uint32_t children = 0; ///< mask
    std::uint32_t kept_children = 0;
    bool kept = false;
  };

  /// Colours of all squares of the product, children before parents.
  void find_averages() {
    const auto nodes = m_product.nodes();
    m_averages.resize(4 * nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;)
      for (std::size_t q = 0; q < 4; ++q) {
        const std::int32_t child = nodes[i].child[q];
        m_averages[4 * i + q] =
            child >= 0 ? mean_of_quadrants(m_averages.data() + 4 * child) : average_of_leaf(child);
      }
    m_mean = to_rgb(mean_of_quadrants(m_averages.data()));
  }

  Float4 average_of_leaf(std::int32_t child) const {
    const ProductLeaf leaf = m_product.leaf(child);
    return leaf.light * leaf.reflectance;
  }

  Item product_item(std::int32_t product_node) const {
    const auto d = differences_of_quadrants(m_averages.data() + 4 * product_node);
    Item item;
    item.product_node = product_node;
    item.details = {d[0], d[1], d[2]};
    return item;
  }

  Item tree_item(std::uint32_t remaining, std::uint32_t node, Float4 scale) const {
    const Details d = m_product.remaining_tree(remaining).details(node);
    Item item;
    item.node = node;
    item.remaining = remaining;
    item.scale = scale;
    item.details = {d.d1 * scale, d.d2 * scale, d.d3 * scale};
    return item;
  }

  void add_children(std::size_t index) {
    m_items[index].first_child = static_cast<std::uint32_t>(m_items.size());
    for (unsigned q = 0; q < 4; ++q) {
      const Item parent = m_items[index];
      if (parent.product_node < 0) {
        const std::uint32_t child =
            m_product.remaining_tree(parent.remaining).child(parent.node, q);
        if (child != no_node)
          add_child(index, q, tree_item(parent.remaining, child, parent.scale));
        continue;
      }
      const std::int32_t child =
          m_product.nodes()[static_cast<std::size_t>(parent.product_node)].child[q];
      if (child >= 0) {
        add_child(index, q, product_item(child));
        continue;
      }
      const ProductLeaf leaf = m_product.leaf(child);
      if (leaf.node != no_node)
        add_child(index, q, tree_item(leaf.remaining, leaf.node, leaf.reflectance));
    }
  }

  void add_child(std::size_t parent, unsigned q, Item item) {
    item.level = m_items[parent].level + 1;
    m_items[parent].children |= 1U << q;
    m_items.push_back(item);
  }

  /// Marks the nodes that have a coefficient above the threshold in or under them.
  void keep_above(float threshold) {
    for (std::size_t i = m_items.size(); i-- > 0;) {
      Item& item = m_items[i];
      std::uint32_t child = item.first_child;
      for (unsigned q = 0; q < 4; ++q)
        if ((item.children >> q & 1U) != 0 && m_items[child++].kept)
          item.kept_children |= 1U << q;
      item.kept = item.kept_children != 0 ||
                  largest_difference(item.details) * power_of_two(-item.level) > threshold;
    }
  }

  const ProductTree& m_product;
  std::vector<Float4> m_averages; ///< by 4 × product node + quadrant
  Rgb m_mean;
  std::vector<Item> m_items;
};

/// The nodes of a tree, with details weighted by their squares' areas.
class WeightedNodes {
public:
  struct Place {
    std::uint32_t node;
    float area;
  };

  explicit WeightedNodes(const TreeView& tree) : m_tree(tree) {}
  Place root() const { return {m_tree.root(), 1}; }
  Place child(const Place& place, unsigned q) const {
    return {m_tree.child(place.node, q), 0.25F * place.area};
  }
  bool exists(const Place& place) const { return place.node != no_node; }
  Details details(const Place& place) const {
    const Details d = m_tree.details(place.node);
    return {place.area * d.d1, place.area * d.d2, place.area * d.d3};
  }

private:
  const TreeView& m_tree;
};

/// The same of a complete tree, whose details are weighted already.
class DenseNodes {
public:
  using Place = std::uint32_t;

  explicit DenseNodes(std::span<const Details> details) : m_details(details) {}
  Place root() const { return 0; }
  Place child(Place place, unsigned q) const { return 4 * place + 1 + q; }
  bool exists(Place /*place*/) const { return true; }
  const Details& details(Place place) const { return m_details[place]; }

private:
  std::span<const Details> m_details;
};

/// Σ of the products of the details of two trees, weighted by area. Nodes lie breadth first, so
/// that the places of children in the other tree follow in the order in which they are found.
/// @param places working memory
template <class Nodes>
Float4 detail_product(const TreeView& tree, const Nodes& other,
                      std::vector<typename Nodes::Place>& places) {
  if (places.size() < tree.node_count + 4)
    places.resize(2 * tree.node_count + 4);
  auto* const place = places.data();
  std::uint32_t found = 1;
  place[0] = other.root();
  Float4 sum = {};
  for (std::uint32_t node = 0; node < tree.node_count; ++node) {
    const std::uint32_t mask = tree.links[node] & 15U;
    for (unsigned q = 0; q < 4; ++q) { // past the end at most three that are not taken
      place[found] = other.child(place[node], q);
      found += mask >> q & 1U;
    }
    if (!other.exists(place[node]))
      continue;
    const Details t = tree.details(node);
    const Details& o = other.details(place[node]);
    sum += t.d1 * o.d1 + t.d2 * o.d2 + t.d3 * o.d3;
  }
  return sum;
}

Float4 coefficient(const Map& transformed, const Square& s, int m) {
  const float* c = transformed.rgb.data() + 3 * coefficient_index(transformed.size, s, m);
  return Float4{c[0], c[1], c[2], 0};
}

} // namespace

Tree multiply(std::span<const TreeView> trees, const MultiplyOptions& options) {
  assert(!trees.empty());
  SynchronousProduct product;
  int levels = options.levels;
  int channels = options.channels;
  for (const TreeView& tree : trees) {
    levels = std::max(levels, tree.levels);
    channels = std::max(channels, tree.channels);
  }
  return ProductFlattener(product.build(factors_of(trees), std::max(levels, 1)))
      .tree(levels, channels, options);
}

Rgb product_integral(std::span<const TreeView> trees) {
  assert(!trees.empty());
  SynchronousProduct product;
  return product.build(factors_of(trees)).integral();
}

Rgb inner_product(const TreeView& a, const TreeView& b) {
  std::vector<WeightedNodes::Place> places;
  return a.mean * b.mean + to_rgb(detail_product(a, WeightedNodes(b), places));
}

DenseCoefficients::DenseCoefficients(Map map)
    : m_levels(std::countr_zero(static_cast<unsigned>(map.size))) {
  haar_forward(map.rgb.data(), map.size, 3);
  m_mean = to_lanes(map.at(0, 0));
  if (m_levels == 0)
    return;
  std::vector<Square> squares = {Square{}};
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const Square s = squares[i];
    m_details.push_back({coefficient(map, s, 1) * s.area(), coefficient(map, s, 2) * s.area(),
                         coefficient(map, s, 3) * s.area()});
    for (unsigned q = 0; q < 4 && s.level + 1 < m_levels; ++q)
      squares.push_back(s.quadrant(q));
  }
}

void DenseCoefficients::inner_products(std::span<const TreeView> trees, std::span<Rgb> out) const {
  assert(trees.size() == out.size());
  std::vector<DenseNodes::Place> places;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    assert(trees[i].levels <= m_levels);
    out[i] = to_rgb(to_lanes(trees[i].mean) * m_mean +
                    detail_product(trees[i], DenseNodes(m_details), places));
  }
}

} // namespace haarlight::wavelet
