#include <view/packed_trees.h>

#include <algorithm>
#include <cassert>

namespace haarlight::view {

using wavelet::Details;
using wavelet::Map;
using wavelet::TreeView;

namespace {

/// What the largest of many values becomes as a half; leaves room for rounding.
constexpr float largest_half = 32768;

float largest_value(const Map& map) {
  float largest = 0;
  for (const float value : map.rgb)
    largest = std::max(largest, std::abs(value));
  return largest;
}

float largest_detail(const TreeView& tree) {
  float largest = 0;
  for (std::uint32_t node = 0; node < tree.node_count; ++node) {
    const Details d = tree.details(node);
    for (int c = 0; c < 3; ++c)
      largest = std::max({largest, std::abs(d.d1[c]), std::abs(d.d2[c]), std::abs(d.d3[c])});
  }
  return largest;
}

/// The tree's own for halves, so that they come out as they were.
float scale_of(const TreeView& tree) {
  if (tree.type == wavelet::CoefficientType::Half)
    return tree.scale;
  const float largest = largest_detail(tree);
  return largest > 0 ? largest / largest_half : 1;
}

void put_texel(std::uint16_t* texel, Float4 value, float unit) {
  for (int c = 0; c < 3; ++c)
    texel[c] = wavelet::float_to_half(std::clamp(value[c] / unit, -65504.0F, 65504.0F));
}

void put_level(const Map& map, std::uint16_t* slice, float unit) {
  const int size = map.size;
  const int x0 = size == top_side ? 0 : top_side;
  const int y0 = size == top_side ? 0 : top_side - 2 * size;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      put_texel(slice + 4 * ((y0 + y) * slice_width + x0 + x), wavelet::to_lanes(map.at(x, y)),
                unit);
}

/// The node of a square of top_level plus 1, or 0.
std::uint32_t start_of(const TreeView& tree, int x, int y) {
  std::uint32_t node = tree.root();
  for (int l = top_level - 1; l >= 0 && node != wavelet::no_node; --l)
    node = tree.child(node, static_cast<unsigned>(((x >> l) & 1) | (((y >> l) & 1) << 1)));
  return node + 1;
}

class Packer {
public:
  explicit Packer(std::span<const TreeView> trees) : m_trees(trees) {
    m_packed.columns = static_cast<int>(trees.size());
    for (const TreeView& tree : trees)
      m_packed.nodes += tree.node_count;
    assert(m_packed.nodes < 1U << 28U);
    m_packed.node_rows = static_cast<int>(m_packed.nodes / nodes_per_row) + 1;
    const std::size_t places =
        static_cast<std::size_t>(m_packed.node_rows) * static_cast<std::size_t>(nodes_per_row);
    m_packed.links.resize(places);
    m_packed.coefficients.resize(12 * places);
    m_packed.tops.resize(slice_texels * 4 * trees.size());
  }

  PackedTrees pack() {
    set_top_unit();
    std::uint32_t base = 0;
    for (std::size_t column = 0; column < m_trees.size(); ++column) {
      add_tops(column);
      add_starts(m_trees[column], base);
      add_nodes(m_trees[column], base);
      base += m_trees[column].node_count;
    }
    return std::move(m_packed);
  }

private:
  static constexpr std::size_t slice_texels =
      static_cast<std::size_t>(slice_width) * static_cast<std::size_t>(slice_height);

  /// Averages of coarser squares are no larger.
  void set_top_unit() {
    float largest = 0;
    for (const TreeView& tree : m_trees)
      largest = std::max(largest, largest_value(tree.reconstruct(top_level)));
    m_packed.top_unit = largest > 0 ? largest / largest_half : 1;
  }

  void add_tops(std::size_t column) {
    std::uint16_t* const slice = m_packed.tops.data() + slice_texels * 4 * column;
    for (int level = 0; level <= top_level; ++level)
      put_level(m_trees[column].reconstruct(level), slice, m_packed.top_unit);
  }

  void add_starts(const TreeView& tree, std::uint32_t base) {
    for (int y = 0; y < top_side; ++y)
      for (int x = 0; x < top_side; ++x) {
        const std::uint32_t start = start_of(tree, x, y);
        m_packed.starts.push_back(start > 0 ? base + start : 0);
      }
  }

  void add_nodes(const TreeView& tree, std::uint32_t base) {
    const float scale = scale_of(tree);
    m_packed.scales.push_back(scale);
    for (std::uint32_t node = 0; node < tree.node_count; ++node) {
      const std::size_t place = base + node;
      const Details d = tree.details(node);
      m_packed.links[place] = tree.links[node] + (base << 4U);
      put_texel(&m_packed.coefficients[12 * place], d.d1, scale);
      put_texel(&m_packed.coefficients[12 * place + 4], d.d2, scale);
      put_texel(&m_packed.coefficients[12 * place + 8], d.d3, scale);
    }
  }

  std::span<const TreeView> m_trees;
  PackedTrees m_packed;
};

} // namespace

std::size_t PackedTrees::bytes() const {
  return 2 * (tops.size() + coefficients.size()) +
         4 * (starts.size() + scales.size() + links.size());
}

PackedTrees pack_trees(std::span<const TreeView> trees) { return Packer(trees).pack(); }

} // namespace haarlight::view
