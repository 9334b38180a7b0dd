#include <wavelet/table_product.h>

namespace haarlight::wavelet {
namespace {

/// Floor of the reflectance in the density, as a share of its mean: thresholding may have lost what
/// a square once held.
constexpr float reflectance_floor = 0.005F;

} // namespace

/// Walks both trees at once; depth first, so that every node comes after its parent.
struct TableProduct::Builder {
  const TreeView& light;
  const TreeView& reflectance;
  SquareSymmetry symmetry;
  ProductTree product;
  std::vector<std::int32_t> parent_slots;

  /// Averages and nodes of both factors over one square.
  struct Pair {
    Float4 light_mean;
    Float4 reflectance_mean;
    std::uint32_t light_node;
    std::uint32_t reflectance_node;
  };

  /// Splits a square into a new product node. @return its index
  std::int32_t split(const Pair& square, std::int32_t slot, int level) {
    const auto index = static_cast<std::int32_t>(product.m_nodes.size());
    product.m_nodes.emplace_back();
    parent_slots.push_back(slot);
    std::array<Float4, 4> lights;
    lights.fill(square.light_mean);
    if (square.light_node != no_node)
      lights = light.details(square.light_node).children(square.light_mean);
    std::array<Float4, 4> stored;
    stored.fill(square.reflectance_mean);
    if (square.reflectance_node != no_node)
      stored = reflectance.details(square.reflectance_node).children(square.reflectance_mean);
    for (unsigned q = 0; q < 4; ++q) {
      const unsigned s = symmetry.to_stored(q);
      const Pair quadrant = {lights[q], stored[s], light.child(square.light_node, q),
                             reflectance.child(square.reflectance_node, s)};
      const std::int32_t below =
          visit(quadrant, 4 * index + static_cast<std::int32_t>(q), level + 1);
      product.m_nodes[static_cast<std::size_t>(index)].child[q] = below;
    }
    return index;
  }

  /// What the product has over a square: a node, or the leaf ~result.
  std::int32_t visit(const Pair& square, std::int32_t slot, int level) {
    if (square.reflectance_node != no_node)
      return split(square, slot, level);
    const Float4 weights = larger(square.reflectance_mean, product.m_floor) * luminance_lanes;
    const float density = std::max(lane_sum(square.light_mean * weights), 0.0F);
    product.m_nodes[static_cast<std::size_t>(slot / 4)].weights[slot % 4] = density;
    ProductLeaf leaf;
    leaf.light = square.light_mean;
    leaf.reflectance = square.reflectance_mean;
    leaf.node = square.light_node;
    leaf.slot = slot;
    leaf.level = level;
    product.m_leaves.push_back(leaf);
    return ~static_cast<std::int32_t>(product.m_leaves.size() - 1);
  }

  /// The root is always a node, even if the reflectance is constant.
  void run() {
    product.m_light = light;
    split({to_lanes(light.mean), to_lanes(reflectance.mean), light.root(), reflectance.root()}, -1,
          0);
    product.m_leaf_count = product.m_leaves.size();
    product.sum_upwards(parent_slots);
  }
};

ProductTree TableProduct::build(const TreeView& light, const TreeView& reflectance,
                                const SquareSymmetry& symmetry) {
  Builder builder = {light, reflectance, symmetry, {}, {}};
  builder.product.m_floor = larger(to_lanes(reflectance.mean) * reflectance_floor, Float4{});
  builder.run();
  return std::move(builder.product);
}

} // namespace haarlight::wavelet
