#include <wavelet/product.h>

namespace haarlight::wavelet {

void ProductTree::sum_upwards(const std::vector<std::int32_t>& parent_slots) {
  for (std::size_t i = m_nodes.size(); i-- > 1;) {
    const std::int32_t slot = parent_slots[i];
    m_nodes[static_cast<std::size_t>(slot / 4)].weights[slot % 4] =
        0.25F * lane_sum(m_nodes[i].weights);
  }
}

Descent ProductTree::sample(float u1, float u2) const {
  Descent d;
  d.u1 = u1;
  d.u2 = u2;
  std::int32_t next = 0;
  while (next >= 0) {
    const ProductNode& node = m_nodes[static_cast<std::size_t>(next)];
    const unsigned q = steer(d, node.weights);
    next = node.child[q];
    d.pdf = node.weights[q]; // a node's mean is its parent's weight: only the last one counts
  }
  d.pdf /= mean();
  descend_tree(d, density(~next));
  return d;
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
  follow_tree(d, density(~next), u, v);
  return d.pdf;
}

} // namespace haarlight::wavelet
