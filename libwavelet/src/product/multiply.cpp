#include <wavelet/product/multiply.h>

#include "tree/coefficient_writer.h"

#include <wavelet/product/synchronous_product.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// Factors for trees, and pointers to them.
struct TreeFactors {
  std::vector<TreeFactor> factors;
  std::vector<const Factor*> pointers;

  explicit TreeFactors(std::span<const TreeView> trees) {
    for (const TreeView& tree : trees)
      factors.emplace_back(tree);
    for (const TreeFactor& factor : factors)
      pointers.push_back(&factor);
  }
};

/// Turns a product into a tree: first all its nodes, breadth first, then those that are kept.
class ProductFlattener {
public:
  explicit ProductFlattener(const ProductTree& product) : m_product(product) {
    find_averages();
    lay_out();
  }

  Tree tree(int levels, int channels, const MultiplyOptions& options) {
    const double mean = static_cast<double>(luminance(m_mean));
    keep_above(static_cast<float>(options.tolerance * mean));
    return written(levels, channels, options.coefficients);
  }

private:
  /// A node of the product tree to be: of the walk, or of a factor's tree times a constant.
  struct Item {
    std::int32_t product_node = -1;
    std::uint32_t node = no_node;
    std::uint32_t rest = 0;
    Float4 scale = {};
    Details details = {};
    std::uint32_t first_child = 0;
    std::uint32_t mask = 0;
    std::uint32_t kept = 0; ///< mask of the kept children; bit 4: this one is kept
  };
  static constexpr std::uint32_t kept_itself = 16;

  /// Colours of all squares of the walk, children before parents.
  void find_averages() {
    const auto nodes = m_product.nodes();
    m_averages.resize(4 * nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;)
      for (std::size_t q = 0; q < 4; ++q) {
        const std::int32_t child = nodes[i].child[q];
        m_averages[4 * i + q] =
            child >= 0 ? mean_of(static_cast<std::size_t>(child)) : average_of_leaf(child);
      }
    m_mean = to_rgb(mean_of(0));
  }

  Float4 average_of_leaf(std::int32_t child) const {
    const ProductLeaf leaf = m_product.leaf(child);
    return leaf.light * leaf.reflectance;
  }

  Float4 mean_of(std::size_t node) const {
    const Float4* a = m_averages.data() + 4 * node;
    return 0.25F * ((a[0] + a[1]) + (a[2] + a[3]));
  }

  void lay_out() {
    m_items.push_back(walk_item(0));
    m_level_begin = {0};
    for (std::size_t begin = 0; begin < m_items.size();) {
      const std::size_t end = m_items.size();
      for (std::size_t i = begin; i < end; ++i) {
        m_items[i].first_child = static_cast<std::uint32_t>(m_items.size());
        add_children(i);
      }
      m_level_begin.push_back(end);
      begin = end;
    }
  }

  Item walk_item(std::int32_t product_node) const {
    const Float4* a = m_averages.data() + 4 * static_cast<std::size_t>(product_node);
    Item item;
    item.product_node = product_node;
    item.details = {0.25F * ((a[0] + a[2]) - (a[1] + a[3])),
                    0.25F * ((a[0] + a[1]) - (a[2] + a[3])),
                    0.25F * ((a[0] + a[3]) - (a[1] + a[2]))};
    return item;
  }

  Item tree_item(std::uint32_t rest, std::uint32_t node, Float4 scale) const {
    Item item;
    item.node = node;
    item.rest = rest;
    item.scale = scale;
    const Details d = m_product.rest(rest).details(node);
    item.details = {d.d1 * scale, d.d2 * scale, d.d3 * scale};
    return item;
  }

  void add_children(std::size_t index) {
    for (unsigned q = 0; q < 4; ++q) {
      const Item parent = m_items[index];
      if (parent.product_node < 0) {
        const std::uint32_t child = m_product.rest(parent.rest).child(parent.node, q);
        if (child != no_node)
          add_child(index, q, tree_item(parent.rest, child, parent.scale));
        continue;
      }
      const std::int32_t child =
          m_product.nodes()[static_cast<std::size_t>(parent.product_node)].child[q];
      if (child >= 0) {
        add_child(index, q, walk_item(child));
        continue;
      }
      const ProductLeaf leaf = m_product.leaf(child);
      if (leaf.node != no_node)
        add_child(index, q, tree_item(leaf.rest, leaf.node, leaf.reflectance));
    }
  }

  void add_child(std::size_t parent, unsigned q, const Item& item) {
    m_items[parent].mask |= 1U << q;
    m_items.push_back(item);
  }

  /// Marks the nodes that have a coefficient above the threshold in or under them.
  void keep_above(float threshold) {
    for (std::size_t level = m_level_begin.size() - 1; level-- > 0;)
      for (std::size_t i = m_level_begin[level]; i < m_level_begin[level + 1]; ++i) {
        Item& item = m_items[i];
        item.kept = 0;
        std::uint32_t child = item.first_child;
        for (unsigned q = 0; q < 4; ++q)
          if ((item.mask >> q & 1U) != 0 && (m_items[child++].kept & kept_itself) != 0)
            item.kept |= 1U << q;
        if (item.kept != 0 ||
            largest(item.details) * power_of_two(-static_cast<int>(level)) > threshold)
          item.kept |= kept_itself;
      }
  }

  static float largest(const Details& d) {
    const Float4 all = larger(larger(absolute(d.d1), absolute(d.d2)), absolute(d.d3));
    return std::max({all[0], all[1], all[2]});
  }

  Tree written(int levels, int channels, CoefficientType type) const {
    Tree tree;
    tree.levels = levels;
    tree.channels = channels;
    tree.type = type;
    tree.mean = m_mean;
    float top = 0;
    for (const Item& item : m_items)
      if ((item.kept & kept_itself) != 0)
        top = std::max(top, largest(item.details));
    tree.scale = coefficient_scale(type, top);
    CoefficientWriter writer(tree);
    tree.level_begin = {0};
    for (std::size_t level = 0; level < static_cast<std::size_t>(levels); ++level)
      write_level(level, writer, tree);
    writer.finish();
    return tree;
  }

  void write_level(std::size_t level, CoefficientWriter& writer, Tree& tree) const {
    std::vector<const Item*> kept;
    if (level + 1 < m_level_begin.size())
      for (std::size_t i = m_level_begin[level]; i < m_level_begin[level + 1]; ++i)
        if ((m_items[i].kept & kept_itself) != 0)
          kept.push_back(&m_items[i]);
    std::size_t child = tree.links.size() + kept.size();
    for (const Item* item : kept) {
      const std::uint32_t mask = item->kept & 15U;
      tree.links.push_back(static_cast<std::uint32_t>(child << 4U) | mask);
      child += detail::bits_of_nibble(mask);
      writer.append(item->details);
    }
    tree.level_begin.push_back(static_cast<std::uint32_t>(tree.links.size()));
  }

  const ProductTree& m_product;
  std::vector<Float4> m_averages; ///< by 4 × product node + quadrant
  Rgb m_mean;
  std::vector<Item> m_items;
  std::vector<std::size_t> m_level_begin;
};

/// Σ of the products of the differences under a square, weighted by area.
Float4 inner_product_below(const TreeView& a, std::uint32_t in_a, const TreeView& b,
                           std::uint32_t in_b, float area) {
  if (in_a == no_node || in_b == no_node)
    return Float4{};
  const Details da = a.details(in_a);
  const Details db = b.details(in_b);
  Float4 sum = area * (da.d1 * db.d1 + da.d2 * db.d2 + da.d3 * db.d3);
  for (unsigned q = 0; q < 4; ++q)
    sum += inner_product_below(a, a.child(in_a, q), b, b.child(in_b, q), 0.25F * area);
  return sum;
}

} // namespace

Tree multiply(std::span<const TreeView> trees, const MultiplyOptions& options) {
  assert(!trees.empty());
  const TreeFactors factors(trees);
  SynchronousProduct product;
  int levels = options.levels;
  int channels = options.channels;
  for (const TreeView& tree : trees) {
    levels = std::max(levels, tree.levels);
    channels = std::max(channels, tree.channels);
  }
  return ProductFlattener(product.build(factors.pointers, std::max(levels, 1)))
      .tree(levels, channels, options);
}

Rgb product_integral(std::span<const TreeView> trees) {
  assert(!trees.empty());
  const TreeFactors factors(trees);
  SynchronousProduct product;
  return product.build(factors.pointers).integral();
}

Rgb inner_product(const TreeView& a, const TreeView& b) {
  return a.mean * b.mean + to_rgb(inner_product_below(a, a.root(), b, b.root(), 1));
}

} // namespace haarlight::wavelet
