#pragma once
// Writes trees, node by node.

#include <wavelet/tree/tree.h>

#include <array>

namespace haarlight::wavelet {

/// Halves are stored below it, which leaves room below the largest half, 65504.
inline constexpr float largest_stored_half = 32768;
/// Magnitudes up to this one are rounded to zero.
inline constexpr float smallest_stored_half = 0x1p-25F;

/// A power of two that scales the largest difference to just below largest_stored_half; 1 for
/// floats.
float coefficient_scale(CoefficientType type, float largest_difference);

/// The largest magnitude of any difference of any channel.
float largest_difference(const Details& details);

/// Appends the links of a tree's nodes and its level table. Nodes are added breadth first, in the
/// order in which their parents name them.
class LinkWriter {
public:
  /// @param tree its links and level table are cleared
  explicit LinkWriter(Tree& tree) : m_tree(&tree) {
    tree.links.clear();
    tree.level_begin.assign(1, 0);
  }

  /// @param children mask of the node's children
  void add(std::uint32_t children) {
    m_tree->links.push_back(m_next_child << 4U | children);
    m_next_child += detail::bits_of_nibble(children);
    if (m_tree->links.size() == m_level_end)
      end_level();
  }

  /// Nodes in all levels down to the current one.
  std::uint32_t level_end() const { return m_level_end; }
  /// Nodes named so far, by parents or as the root.
  std::uint32_t named_nodes() const { return m_next_child; }

  /// Completes the level table. @pre all nodes named were added
  void finish() {
    const auto levels = static_cast<std::size_t>(m_tree->levels);
    m_tree->level_begin.resize(levels + 1, static_cast<std::uint32_t>(m_tree->links.size()));
  }

private:
  void end_level() {
    m_tree->level_begin.push_back(m_level_end);
    m_level_end = m_next_child;
  }

  Tree* m_tree;
  std::uint32_t m_next_child = 1;
  std::uint32_t m_level_end = 1;
};

/// Appends nodes and their coefficients to a tree.
class TreeWriter {
public:
  /// @param tree its levels, channels, type, scale and mean are set; its arrays are cleared
  explicit TreeWriter(Tree& tree) : m_tree(tree), m_links(tree) { tree.coefficients.clear(); }

  /// Appends the next node, breadth first. Trees of one channel get the luminance.
  void add(std::uint32_t children, const Details& details);
  /// The same for a tree of one channel. @param differences d_1, d_2, d_3
  void add(std::uint32_t children, const std::array<float, 3>& differences);

  /// Completes the level table and pads the coefficients, so that lanes may be loaded from their
  /// end.
  void finish();

private:
  void append(float value);

  Tree& m_tree;
  LinkWriter m_links;
};

} // namespace haarlight::wavelet
