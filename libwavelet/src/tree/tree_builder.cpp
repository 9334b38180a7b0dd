#include "tree/tree_builder.h"

#include "tree/coefficient_writer.h"

#include <wavelet/transform/transform.h>

#include <bit>
#include <cmath>

namespace haarlight::wavelet {
namespace {

struct Square {
  int x;
  int y;
};

class TreeBuilder {
public:
  TreeBuilder(const Map& map, int channels, CoefficientType type)
      : m_map(map), m_levels(std::countr_zero(static_cast<unsigned>(map.size))) {
    m_tree.levels = m_levels;
    m_tree.channels = channels;
    m_tree.type = type;
    const Rgb mean = map.at(0, 0);
    m_tree.mean = channels == 3 ? mean : Rgb::Constant(luminance(mean));
  }

  Tree build(float scale) {
    choose_scale(scale);
    mark_squares();
    m_tree.level_begin.assign(1, 0);
    std::vector<Square> level;
    if (m_levels > 0 && m_present[0][0] != 0)
      level.push_back({0, 0});
    for (int l = 0; l < m_levels; ++l)
      level = append_level(l, level);
    m_writer.finish();
    return std::move(m_tree);
  }

private:
  const float* coefficient(int level, int x, int y, int m) const {
    return m_map.rgb.data() + 3 * coefficient_index(m_map.size, level, x, y, m);
  }

  bool has_detail(int level, int x, int y) const {
    for (int m = 1; m <= 3; ++m) {
      const float* c = coefficient(level, x, y, m);
      if (is_stored(c[0]) || is_stored(c[1]) || is_stored(c[2]))
        return true;
    }
    return false;
  }

  /// False for differences that become zeros in halves.
  bool is_stored(float difference) const {
    return difference != 0 && (m_tree.type == CoefficientType::Float ||
                               std::abs(difference) / m_tree.scale > smallest_stored_half);
  }

  /// Which squares have a wavelet in or under them, finest level first.
  void mark_squares() {
    m_present.resize(static_cast<std::size_t>(m_levels));
    for (int l = m_levels - 1; l >= 0; --l) {
      const int side = 1 << l;
      auto& marks = m_present[static_cast<std::size_t>(l)];
      marks.resize(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          marks[place(l, x, y)] = has_detail(l, x, y) || child_mask(l, x, y) != 0 ? 1 : 0;
    }
  }

  static std::size_t place(int level, int x, int y) {
    return (static_cast<std::size_t>(y) << static_cast<unsigned>(level)) +
           static_cast<std::size_t>(x);
  }

  unsigned child_mask(int level, int x, int y) const {
    if (level + 1 >= m_levels)
      return 0;
    const auto& marks = m_present[static_cast<std::size_t>(level) + 1];
    unsigned mask = 0;
    for (int q = 0; q < 4; ++q)
      if (marks[place(level + 1, 2 * x + (q & 1), 2 * y + (q >> 1))] != 0)
        mask |= 1U << static_cast<unsigned>(q);
    return mask;
  }

  /// The scale given, if it is one and the largest difference fits it.
  void choose_scale(float scale) {
    float largest = 0;
    for (std::size_t i = 3; i < m_map.rgb.size(); ++i)
      largest = std::max(largest, std::abs(m_map.rgb[i]));
    const bool fits = scale > 0 && largest / scale <= largest_stored_half;
    m_tree.scale = fits ? scale : coefficient_scale(m_tree.type, largest);
  }

  /// Appends a level's nodes and returns the squares of the next.
  std::vector<Square> append_level(int level, const std::vector<Square>& squares) {
    std::vector<Square> next;
    const std::size_t end = m_tree.links.size() + squares.size();
    for (const Square& s : squares) {
      const unsigned mask = child_mask(level, s.x, s.y);
      m_tree.links.push_back(static_cast<std::uint32_t>((end + next.size()) << 4U) | mask);
      m_writer.append(details(level, s));
      for (int q = 0; q < 4; ++q)
        if (((mask >> static_cast<unsigned>(q)) & 1U) != 0)
          next.push_back({2 * s.x + (q & 1), 2 * s.y + (q >> 1)});
    }
    m_tree.level_begin.push_back(static_cast<std::uint32_t>(m_tree.links.size()));
    return next;
  }

  Details details(int level, const Square& s) const {
    Details result;
    Float4* const d[3] = {&result.d1, &result.d2, &result.d3};
    for (int m = 1; m <= 3; ++m) {
      const float* c = coefficient(level, s.x, s.y, m);
      *d[m - 1] = Float4{c[0], c[1], c[2], 0};
    }
    return result;
  }

  const Map& m_map;
  int m_levels;
  Tree m_tree;
  CoefficientWriter m_writer{m_tree};
  std::vector<std::vector<std::uint8_t>> m_present;
};

} // namespace

Tree build_tree(const Map& transformed, int channels, CoefficientType type, float scale) {
  return TreeBuilder(transformed, channels, type).build(scale);
}

} // namespace haarlight::wavelet
