#include <wavelet/base/cpu_clones.h>
#include <wavelet/product/product_tree.h>

#include <array>

namespace haarlight::wavelet {

Rgb ProductTree::integral() const {
  if (m_integral)
    return *m_integral;
  Float4 sum = {};
  for (const ProductNode& node : m_nodes)
    for (const std::int32_t child : node.child)
      if (child < 0) {
        const ProductLeaf& leaf = m_leaves[static_cast<std::uint32_t>(~child)];
        sum += leaf.light * leaf.reflectance * leaf.square.area();
      }
  return to_rgb(sum);
}

/// The remaining factor is the last one that has detail.
ProductLeaf ProductTree::leaf_at_slot(std::int32_t slot) const {
  const auto i = static_cast<std::size_t>(slot);
  std::size_t remaining = m_slots.size() - 1;
  while (remaining > 0 && m_slots[remaining].nodes[i] == no_node)
    --remaining;
  ProductLeaf leaf;
  leaf.reflectance = Float4{1, 1, 1, 0};
  for (std::size_t f = 0; f < m_slots.size(); ++f)
    if (f != remaining)
      leaf.reflectance *= m_slots[f].means[i];
  leaf.light = m_slots[remaining].means[i];
  leaf.node = m_slots[remaining].nodes[i];
  leaf.remaining = static_cast<std::uint8_t>(remaining);
  return leaf;
}

void ProductTree::sum_upwards(const std::vector<std::int32_t>& parent_slots) {
  for (std::size_t i = m_nodes.size(); i-- > 1;) {
    const std::int32_t slot = parent_slots[i];
    m_nodes[static_cast<std::size_t>(slot / 4)].weights[slot % 4] =
        0.25F * lane_sum(m_nodes[i].weights);
  }
}

/// Descends to a leaf. @return the node entry that names the leaf, ~slot
std::int32_t ProductTree::descend_nodes(Descent& d) const {
  std::int32_t next = 0;
  while (next >= 0) {
    const ProductNode& node = m_nodes[static_cast<std::size_t>(next)];
    const unsigned q = steer(d, node.weights);
    next = node.child[q];
    d.pdf = node.weights[q]; // a node's mean is its parent's weight: only the last one counts
  }
  d.pdf /= mean();
  return next;
}

Descent ProductTree::sample(float u1, float u2) const {
  Descent d;
  d.u1 = u1;
  d.u2 = u2;
  descend_tree(density(descend_nodes(d)), d);
  return d;
}

HAARLIGHT_CPU_CLONES void ProductTree::sample(std::span<const Vec2> points,
                                              std::span<Descent> out) const {
  std::array<TreeDensity, 64> densities;
  for (std::size_t begin = 0; begin < out.size(); begin += densities.size()) {
    const std::span<Descent> batch =
        out.subspan(begin, std::min(densities.size(), out.size() - begin));
    for (std::size_t i = 0; i < batch.size(); ++i) {
      batch[i] = {};
      batch[i].u1 = points[begin + i].x();
      batch[i].u2 = points[begin + i].y();
      densities[i] = density(descend_nodes(batch[i]));
    }
    descend_tree(std::span(densities).first(batch.size()), batch);
  }
}

float ProductTree::pdf(float u, float v) const {
  if (empty())
    return 0;
  Descent d;
  std::int32_t next = 0;
  while (next >= 0) {
    const ProductNode& node = m_nodes[static_cast<std::size_t>(next)];
    const unsigned q = steer_to(d, u, v);
    next = node.child[q];
    d.pdf = node.weights[q];
    if (!(d.pdf > 0))
      return 0;
  }
  d.pdf /= mean();
  follow_tree(density(next), u, v, d);
  return d.pdf;
}

} // namespace haarlight::wavelet
