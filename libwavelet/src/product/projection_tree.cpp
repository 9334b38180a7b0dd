// From the squares of a projection to a pruned tree.
#include <wavelet/product/projection.h>

#include "tree/coefficient_writer.h"

#include <algorithm>

namespace haarlight::wavelet {
namespace {

Float4 largest(const Details& d) {
  return larger(larger(absolute(d.d1), absolute(d.d2)), absolute(d.d3));
}

} // namespace

/// Dropping a node drops all nodes under it.
void Projection::find_costs() {
  m_costs.resize(m_nodes.size());
  for (std::size_t node = m_nodes.size(); node-- > 0;) {
    const Details d = details_of(node);
    const Float4 squares = d.d1 * d.d1 + d.d2 * d.d2 + d.d3 * d.d3;
    const float brightness = lane_sum(mean_of(node) * luminance_lanes);
    const float floor = std::max(brightness, darkest * m_brightness) * m_brightness;
    const float area = power_of_two(-2 * m_nodes[node].level);
    const float own = floor > 0 ? area * lane_sum(squares * luminance_lanes) / floor : 0;
    float under = own;
    for (const std::int32_t child : m_nodes[node].child)
      under += child >= 0 ? m_costs[static_cast<std::size_t>(child)].under : 0;
    m_costs[node] = {own, under};
  }
}

/// The largest cost such that all nodes of this cost or less can be dropped together.
float Projection::choose_limit() {
  const double budget = m_options.tolerance * m_options.tolerance;
  m_sorted = m_costs;
  std::sort(m_sorted.begin(), m_sorted.end(), [](const Cost& a, const Cost& b) {
    return a.under != b.under ? a.under < b.under : a.own < b.own;
  });
  float limit = 0;
  double dropped = m_report.dropped;
  for (std::size_t i = 0; i < m_sorted.size(); ++i) {
    dropped += static_cast<double>(m_sorted[i].own);
    if (dropped > budget)
      break;
    const bool last_of_its_cost =
        i + 1 == m_sorted.size() || m_sorted[i + 1].under > m_sorted[i].under;
    if (last_of_its_cost) {
      limit = m_sorted[i].under;
      m_report.dropped = dropped;
    }
  }
  return limit;
}

std::uint32_t Projection::kept_children(std::size_t node, float limit) const {
  std::uint32_t mask = 0;
  for (std::size_t q = 0; q < 4; ++q) {
    const std::int32_t child = m_nodes[node].child[q];
    if (child >= 0 && m_costs[static_cast<std::size_t>(child)].under > limit)
      mask |= 1U << q;
  }
  return mask;
}

float Projection::top_difference(float limit) const {
  float top = 0;
  for (std::size_t node = 0; node < m_nodes.size(); ++node)
    if (m_costs[node].under > limit) {
      const Float4 all = largest(details_of(node));
      top = std::max({top, all[0], all[1], all[2]});
    }
  return top;
}

/// Breadth first, whatever the order in which nodes were made.
Tree Projection::written(float limit) {
  Tree tree;
  tree.levels = m_options.levels;
  tree.type = m_options.coefficients;
  tree.mean = to_rgb(m_mean);
  tree.scale = coefficient_scale(tree.type, top_difference(limit));
  tree.level_begin = {0};
  CoefficientWriter writer(tree);
  m_queue.clear();
  if (m_costs[0].under > limit)
    m_queue.push_back(0);
  std::size_t i = 0;
  for (int level = 0; level < tree.levels; ++level) {
    for (const std::size_t end = m_queue.size(); i < end; ++i) {
      const auto node = static_cast<std::size_t>(m_queue[i]);
      const std::uint32_t mask = kept_children(node, limit);
      tree.links.push_back(static_cast<std::uint32_t>(m_queue.size() << 4U) | mask);
      writer.append(details_of(node));
      for (std::size_t q = 0; q < 4; ++q)
        if ((mask >> q & 1U) != 0)
          m_queue.push_back(m_nodes[node].child[q]);
    }
    tree.level_begin.push_back(static_cast<std::uint32_t>(i));
  }
  writer.finish();
  return tree;
}

} // namespace haarlight::wavelet
