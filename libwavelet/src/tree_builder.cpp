#include "tree_builder.h"

#include <wavelet/transform.h>

#include <bit>
#include <cmath>

namespace haarlight::wavelet {
namespace {

/// Largest magnitude of a stored half coefficient: leaves room below the half's 65504.
constexpr int half_exponent = 15;

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
    mark_squares();
    choose_scale(scale);
    m_tree.level_begin.assign(1, 0);
    std::vector<Square> level;
    if (m_levels > 0 && m_present[0][0] != 0)
      level.push_back({0, 0});
    for (int l = 0; l < m_levels; ++l)
      level = append_level(l, level);
    m_tree.coefficients.resize(m_tree.coefficients.size() + 8);
    return std::move(m_tree);
  }

private:
  const float* coefficient(int level, int x, int y, int m) const {
    return m_map.rgb.data() + 3 * coefficient_index(m_map.size, level, x, y, m);
  }

  bool has_detail(int level, int x, int y) const {
    for (int m = 1; m <= 3; ++m) {
      const float* c = coefficient(level, x, y, m);
      if (c[0] != 0 || c[1] != 0 || c[2] != 0)
        return true;
    }
    return false;
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

  /// The scale given, or a power of two that brings the largest difference just under
  /// 2^half_exponent; 1 for floats.
  void choose_scale(float scale) {
    if (m_tree.type == CoefficientType::Float)
      return;
    float largest = 0;
    for (std::size_t i = 3; i < m_map.rgb.size(); ++i)
      largest = std::max(largest, std::abs(m_map.rgb[i]));
    if (largest == 0)
      return;
    if (scale > 0 && largest / scale < std::ldexp(1.0F, half_exponent)) {
      m_tree.scale = scale;
      return;
    }
    int exponent = 0;
    std::frexp(largest, &exponent);
    m_tree.scale = std::ldexp(1.0F, std::max(exponent - half_exponent, -100));
  }

  /// Appends a level's nodes and returns the squares of the next.
  std::vector<Square> append_level(int level, const std::vector<Square>& squares) {
    std::vector<Square> next;
    const std::size_t end = m_tree.links.size() + squares.size();
    for (const Square& s : squares) {
      const unsigned mask = child_mask(level, s.x, s.y);
      m_tree.links.push_back(static_cast<std::uint32_t>((end + next.size()) << 4U) | mask);
      append_coefficients(level, s);
      for (int q = 0; q < 4; ++q)
        if (((mask >> static_cast<unsigned>(q)) & 1U) != 0)
          next.push_back({2 * s.x + (q & 1), 2 * s.y + (q >> 1)});
    }
    m_tree.level_begin.push_back(static_cast<std::uint32_t>(m_tree.links.size()));
    return next;
  }

  void append_coefficients(int level, const Square& s) {
    for (int m = 1; m <= 3; ++m) {
      const float* c = coefficient(level, s.x, s.y, m);
      if (m_tree.channels == 1)
        append_value(luminance(Eigen::Map<const Rgb>(c)));
      else
        for (int i = 0; i < 3; ++i)
          append_value(c[i]);
    }
  }

  void append_value(float value) {
    auto& bytes = m_tree.coefficients;
    const std::size_t at = bytes.size();
    bytes.resize(at + coefficient_bytes(m_tree.type));
    if (m_tree.type == CoefficientType::Float) {
      std::memcpy(bytes.data() + at, &value, 4);
      return;
    }
    const std::uint16_t half = float_to_half(value / m_tree.scale);
    std::memcpy(bytes.data() + at, &half, 2);
  }

  const Map& m_map;
  int m_levels;
  Tree m_tree;
  std::vector<std::vector<std::uint8_t>> m_present;
};

} // namespace

Tree build_tree(const Map& transformed, int channels, CoefficientType type, float scale) {
  return TreeBuilder(transformed, channels, type).build(scale);
}

} // namespace haarlight::wavelet
