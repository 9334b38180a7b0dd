#include <wavelet/product/region.h>

#include "tree/tree_writer.h"

#include <cassert>

namespace haarlight::wavelet {
namespace {

float average_of(const Region& region, const Square& square, RegionPart part) {
  return part == RegionPart::Partial ? region.coverage(square)
                                     : (part == RegionPart::Inside ? 1.0F : 0.0F);
}

} // namespace

void RegionTreeBuilder::build(const Region& region, int levels, Tree& out) {
  assert(levels >= 0 && levels <= 15);
  m_nodes.clear();
  const Square root;
  const RegionPart part = region.classify(root);
  if (part == RegionPart::Partial && levels > 0)
    m_nodes.emplace_back();
  for (std::size_t i = 0; i < m_nodes.size(); ++i)
    split(region, i, levels);
  sum_upwards();
  out.levels = levels;
  out.channels = 1;
  out.type = CoefficientType::Float;
  out.scale = 1;
  out.mean = Rgb::Constant(m_nodes.empty() ? average_of(region, root, part)
                                           : mean_of_quadrants(m_nodes[0].averages));
  TreeWriter writer(out);
  for (const Node& node : m_nodes) {
    if (!node.kept)
      continue;
    std::uint32_t mask = 0;
    for (unsigned q = 0; q < 4; ++q)
      mask |= node.children[q] != no_node ? 1U << q : 0U;
    writer.add(mask, differences_of_quadrants(node.averages));
  }
  writer.finish();
}

void RegionTreeBuilder::split(const Region& region, std::size_t node, int levels) {
  for (unsigned q = 0; q < 4; ++q) {
    const Square square = m_nodes[node].square.quadrant(q);
    const RegionPart part = region.classify(square);
    if (part == RegionPart::Partial && square.level < levels) {
      m_nodes[node].children[q] = static_cast<std::uint32_t>(m_nodes.size());
      m_nodes.push_back({square});
    } else {
      m_nodes[node].averages[q] = average_of(region, square, part);
    }
  }
}

/// Averages of inner squares; nodes that are constant are not kept.
void RegionTreeBuilder::sum_upwards() {
  for (std::size_t i = m_nodes.size(); i-- > 0;) {
    Node& node = m_nodes[i];
    for (unsigned q = 0; q < 4; ++q) {
      if (node.children[q] == no_node)
        continue;
      const Node& child = m_nodes[node.children[q]];
      node.averages[q] = mean_of_quadrants(child.averages);
      if (child.kept)
        node.kept = true;
      else
        node.children[q] = no_node;
    }
    const float* a = node.averages;
    node.kept = node.kept || a[0] != a[1] || a[0] != a[2] || a[0] != a[3];
  }
}

Tree region_tree(const Region& region, int levels) {
  Tree tree;
  RegionTreeBuilder().build(region, levels, tree);
  return tree;
}

} // namespace haarlight::wavelet
