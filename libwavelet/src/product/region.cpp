#include <wavelet/product/region.h>

#include <cassert>
#include <cstring>

namespace haarlight::wavelet {
namespace {

void append(float value, std::vector<std::byte>& bytes) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

void clear(int levels, Tree& tree) {
  tree.levels = levels;
  tree.channels = 1;
  tree.type = CoefficientType::Float;
  tree.scale = 1;
  tree.level_begin.assign(1, 0);
  tree.links.clear();
  tree.coefficients.clear();
}

float average_of(const Region& region, const SquarePlace& square, RegionPart part) {
  return part == RegionPart::Partial ? region.coverage(square)
                                     : (part == RegionPart::Inside ? 1.0F : 0.0F);
}

} // namespace

void RegionTreeBuilder::build(const Region& region, int levels, Tree& out) {
  assert(levels >= 0 && levels <= 15);
  clear(levels, out);
  m_nodes.clear();
  m_level_begin.assign(1, 0);
  const SquarePlace root;
  const RegionPart part = region.classify(root);
  if (part == RegionPart::Partial && levels > 0)
    m_nodes.emplace_back();
  for (int level = 0; level < levels; ++level)
    split_level(region, level, levels);
  sum_upwards();
  const float mean = m_nodes.empty() ? average_of(region, root, part) : m_nodes[0].average();
  out.mean = Rgb::Constant(mean);
  for (std::size_t level = 0; level < static_cast<std::size_t>(levels); ++level)
    write_level(level, out);
  out.coefficients.resize(out.coefficients.size() + 8); // so that lanes may be loaded from its end
}

void RegionTreeBuilder::split_level(const Region& region, int level, int levels) {
  const std::size_t begin = m_level_begin.back();
  const std::size_t end = m_nodes.size();
  for (std::size_t i = begin; i < end; ++i)
    for (unsigned q = 0; q < 4; ++q) {
      const SquarePlace square = SquarePlace{level, m_nodes[i].column, m_nodes[i].row}.quadrant(q);
      const RegionPart part = region.classify(square);
      if (part == RegionPart::Partial && level + 1 < levels) {
        m_nodes[i].children[q] = static_cast<std::uint32_t>(m_nodes.size());
        m_nodes.push_back({square.column, square.row});
      } else {
        m_nodes[i].averages[q] = average_of(region, square, part);
      }
    }
  m_level_begin.push_back(end);
}

void RegionTreeBuilder::sum_upwards() {
  for (std::size_t i = m_nodes.size(); i-- > 0;) {
    Node& node = m_nodes[i];
    for (unsigned q = 0; q < 4; ++q) {
      if (node.children[q] == no_node)
        continue;
      const Node& child = m_nodes[node.children[q]];
      node.averages[q] = child.average();
      if (child.kept)
        node.kept = true;
      else
        node.children[q] = no_node;
    }
    const float* a = node.averages;
    node.kept = node.kept || a[0] != a[1] || a[0] != a[2] || a[0] != a[3];
  }
}

void RegionTreeBuilder::write_level(std::size_t level, Tree& out) const {
  const std::size_t begin = m_level_begin[level];
  const std::size_t end = m_level_begin[level + 1];
  std::size_t next = out.links.size();
  for (std::size_t i = begin; i < end; ++i)
    next += m_nodes[i].kept ? 1 : 0;
  for (std::size_t i = begin; i < end; ++i) {
    const Node& node = m_nodes[i];
    if (!node.kept)
      continue;
    std::uint32_t mask = 0;
    for (unsigned q = 0; q < 4; ++q)
      mask |= node.children[q] != no_node ? 1U << q : 0U;
    out.links.push_back(static_cast<std::uint32_t>(next << 4U) | mask);
    next += detail::bits_of_nibble(mask);
    const float* a = node.averages;
    append(0.25F * ((a[0] + a[2]) - (a[1] + a[3])), out.coefficients);
    append(0.25F * ((a[0] + a[1]) - (a[2] + a[3])), out.coefficients);
    append(0.25F * ((a[0] + a[3]) - (a[1] + a[2])), out.coefficients);
  }
  out.level_begin.push_back(static_cast<std::uint32_t>(out.links.size()));
}

Tree region_tree(const Region& region, int levels) {
  Tree tree;
  RegionTreeBuilder().build(region, levels, tree);
  return tree;
}

} // namespace haarlight::wavelet
