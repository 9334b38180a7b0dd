#include <wavelet/product/adaptive_product.h>

namespace haarlight::wavelet {
namespace {

bool is_black(Float4 c) { return c[0] == 0 && c[1] == 0 && c[2] == 0; }

} // namespace

std::span<const MaskedLeaf> MaskedProduct::build(const ProductTree& product,
                                                 std::span<const TreeView> masks) {
  m_product = &product;
  m_light = &product.remaining_tree(0);
  m_masks.clear();
  m_splits.clear();
  m_leaves.clear();
  m_leaf_masks.clear();
  Masks all;
  for (const TreeView& mask : masks) {
    if (mask.root() == no_node)
      all.scale *= mask.mean[0];
    else
      m_masks.push_back({&mask, mask.root(), mask.mean[0]});
  }
  if (!product.nodes().empty() && all.scale != 0)
    visit(0, all);
  return m_leaves;
}

/// Pushes the quadrants of the masks on m_splits.
void MaskedProduct::split_masks(Masks masks) {
  for (std::size_t i = masks.first; i < m_masks.size(); ++i) {
    const Mask& mask = m_masks[i];
    m_splits.push_back({mask.tree, mask.tree->split(mask.node, Float4{} + mask.mean)});
  }
}

/// Pushes the masks of a quadrant on m_masks.
/// @param splits first of the split masks
MaskedProduct::Masks MaskedProduct::masks_of_quadrant(unsigned q, std::size_t splits, float scale) {
  Masks result = {m_masks.size(), scale};
  for (std::size_t i = splits; i < m_splits.size(); ++i) {
    const auto& [tree, quadrants] = m_splits[i];
    const float mean = quadrants.means[q][0];
    if (quadrants.nodes[q] == no_node)
      result.scale *= mean;
    else
      m_masks.push_back({tree, quadrants.nodes[q], mean});
  }
  return result;
}

void MaskedProduct::visit(std::int32_t child, Masks masks) {
  if (child < 0) {
    const ProductLeaf at = m_product->leaf(child);
    if (is_black(at.reflectance))
      return;
    MaskedLeaf leaf;
    leaf.square = at.square;
    leaf.m_light = at.light;
    leaf.m_node = at.node;
    return add_leaf(leaf, masks, m_leaves);
  }
  const ProductNode& node = m_product->nodes()[static_cast<std::size_t>(child)];
  const std::size_t splits = m_splits.size();
  const std::size_t end = m_masks.size();
  split_masks(masks);
  for (unsigned q = 0; q < 4; ++q) {
    const Masks below = masks_of_quadrant(q, splits, masks.scale);
    if (below.scale != 0)
      visit(node.child[q], below);
    m_masks.resize(end);
  }
  m_splits.resize(splits);
}

/// Appends a leaf unless its masks leave no light.
void MaskedProduct::add_leaf(MaskedLeaf leaf, Masks masks, std::vector<MaskedLeaf>& out) {
  leaf.visible_light = average_below(leaf.m_light, leaf.m_node, masks);
  if (is_black(leaf.visible_light))
    return;
  leaf.m_scale = masks.scale;
  leaf.m_first_mask = static_cast<std::uint32_t>(m_leaf_masks.size());
  leaf.m_mask_count = static_cast<std::uint32_t>(m_masks.size() - masks.first);
  m_leaf_masks.insert(m_leaf_masks.end(),
                      m_masks.begin() + static_cast<std::ptrdiff_t>(masks.first), m_masks.end());
  out.push_back(leaf);
}

void MaskedProduct::split(MaskedLeaf leaf, std::vector<MaskedLeaf>& out) {
  m_masks.clear();
  m_splits.clear();
  for (std::uint32_t i = 0; i < leaf.m_mask_count; ++i)
    m_masks.push_back(m_leaf_masks[leaf.m_first_mask + i]);
  split_masks({});
  const TreeQuadrants light = m_light->split(leaf.m_node, leaf.m_light);
  for (unsigned q = 0; q < 4; ++q) {
    m_masks.clear();
    MaskedLeaf child;
    child.square = leaf.square.quadrant(q);
    child.m_light = light.means[q];
    child.m_node = light.nodes[q];
    const Masks below = masks_of_quadrant(q, 0, leaf.m_scale);
    if (below.scale != 0)
      add_leaf(child, below, out);
  }
}

/// The average of light times masks over a square.
Float4 MaskedProduct::average_below(Float4 mean, std::uint32_t node, Masks masks) {
  const std::size_t end = m_masks.size();
  const std::size_t count = end - masks.first;
  if (count == 0)
    return mean * masks.scale;
  if (count == 1 && node == no_node)
    return mean * (masks.scale * m_masks.back().mean);
  const TreeQuadrants light = m_light->split(node, mean);
  const std::size_t splits = m_splits.size();
  split_masks(masks);
  Float4 sum = {};
  for (unsigned q = 0; q < 4; ++q) {
    const Masks below = masks_of_quadrant(q, splits, masks.scale);
    if (below.scale != 0)
      sum += average_below(light.means[q], light.nodes[q], below);
    m_masks.resize(end);
  }
  m_splits.resize(splits);
  return 0.25F * sum;
}

} // namespace haarlight::wavelet
