#pragma once
// Sparse Haar trees of RGB functions on the unit square.
//
// A node is a square s = (l, x, y) that has wavelets; it holds the three differences d_m of
// <wavelet/transform/transform.h>. Nodes lie in one flat array, breadth first and in Morton order
// within a level, with 4-bit child masks: a missing child means that the function is constant
// there. A node's children follow each other, quadrant q = qx + 2 qy ascending.

#include <wavelet/base/half.h>
#include <wavelet/base/lanes.h>
#include <wavelet/tree/map_set.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace haarlight::wavelet {

enum class CoefficientType : std::uint32_t { Half = 0, Float = 1 };

constexpr std::size_t coefficient_bytes(CoefficientType type) {
  return type == CoefficientType::Half ? 2 : 4;
}

/// Lanes R, G, B, 0 of a colour.
inline Float4 to_lanes(const Rgb& c) { return Float4{c[0], c[1], c[2], 0}; }
inline Rgb to_rgb(Float4 c) { return {c[0], c[1], c[2]}; }

/// Luminance weights as lanes; the dot product with lanes R, G, B, * is the luminance.
inline constexpr Float4 luminance_lanes = {luminance_weights[0], luminance_weights[1],
                                           luminance_weights[2], 0};
inline float lane_sum(Float4 v) { return (v[0] + v[1]) + (v[2] + v[3]); }

/// The three differences of a node, lanes R, G, B, 0, in the unit of the function's values.
struct Details {
  Float4 d1, d2, d3;

  /// Averages over the four child quadrants q = qx + 2 qy of a square of average `mean`.
  std::array<Float4, 4> children(Float4 mean) const {
    const Float4 left = mean + d1;
    const Float4 right = mean - d1;
    const Float4 skew_left = d2 + d3;
    const Float4 skew_right = d2 - d3;
    return {left + skew_left, right + skew_right, left - skew_left, right - skew_right};
  }
};

/// Mean of a square, from the means of its quadrants q = 0 … 3. T: float or Float4.
template <class T>
T mean_of_quadrants(const T* means) {
  return 0.25F * ((means[0] + means[1]) + (means[2] + means[3]));
}

/// The three differences d_m of a square, from the means of its quadrants; the inverse of
/// Details::children(). T: float or Float4.
template <class T>
std::array<T, 3> differences_of_quadrants(const T* means) {
  return {0.25F * ((means[0] + means[2]) - (means[1] + means[3])),
          0.25F * ((means[0] + means[1]) - (means[2] + means[3])),
          0.25F * ((means[0] + means[3]) - (means[1] + means[2]))};
}

namespace detail {

/// Number of bits set in a value below 16; a population count is a function call on plain x86-64.
constexpr std::uint32_t bits_of_nibble(std::uint32_t nibble) {
  return static_cast<std::uint32_t>(0x4332322132212110ULL >> (4U * nibble)) & 15U;
}

} // namespace detail

/// "No such node": the function is constant over the square.
inline constexpr std::uint32_t no_node = 0xffffffffU;

/// The quadrants of a square of a tree's function.
struct TreeQuadrants {
  std::array<Float4, 4> means; ///< lanes R, G, B, *
  std::array<std::uint32_t, 4> nodes;
};

/// A tree somewhere in memory (usually in a mapped file); cheap to copy, owns nothing.
struct TreeView {
  int levels = 0;   ///< squares of the finest wavelets have side 2^-(levels-1)
  int channels = 3; ///< 3 = RGB, 1 = luminance, read back as a grey RGB
  CoefficientType type = CoefficientType::Half;
  std::uint32_t node_count = 0;
  float scale = 1;                      ///< stored coefficients times this are differences
  Rgb mean = Rgb::Zero();               ///< average over the whole square, F⁰_root
  const std::uint32_t* links = nullptr; ///< per node: index of its first child << 4 | child mask
  const std::byte* coefficients = nullptr;

  std::uint32_t root() const { return node_count > 0 ? 0 : no_node; }

  /// Child `q` of a node, or no_node. @param node an existing node or no_node
  std::uint32_t child(std::uint32_t node, unsigned q) const {
    return node == no_node ? no_node : child_of_existing(node, q);
  }

  /// child() of an existing node. Free of branches, which random descents would mispredict.
  std::uint32_t child_of_existing(std::uint32_t node, unsigned q) const {
    const std::uint32_t link = links[node];
    const std::uint32_t present = (link >> q) & 1U;
    const std::uint32_t index = (link >> 4U) + detail::bits_of_nibble(link & ((1U << q) - 1U));
    return index | (present - 1U);
  }

  /// All four children of an existing node.
  std::array<std::uint32_t, 4> children(std::uint32_t node) const {
    const std::uint32_t link = links[node];
    std::uint32_t next = link >> 4U;
    std::array<std::uint32_t, 4> result;
    for (unsigned q = 0; q < 4; ++q) {
      const std::uint32_t present = (link >> q) & 1U;
      result[q] = next | (present - 1U);
      next += present;
    }
    return result;
  }

  /// Asks the processor to fetch a node, or nothing if there is none, before it is needed.
  void prefetch(std::uint32_t node) const {
    const std::size_t place = node == no_node ? 0 : node;
    __builtin_prefetch(links + place);
    __builtin_prefetch(coefficients +
                       place * 3 * static_cast<std::size_t>(channels) * coefficient_bytes(type));
  }

  /// Differences of an existing node.
  Details details(std::uint32_t node) const;

  /// Splits a square of a given average. @param node of the square; no_node where the function is
  /// constant
  TreeQuadrants split(std::uint32_t node, Float4 average) const {
    if (node == no_node)
      return {{average, average, average, average}, {no_node, no_node, no_node, no_node}};
    return {details(node).children(average), children(node)};
  }

  /// Average over the square (level, x, y), by descent from the root: O(level).
  /// @param level 0 … any; below the finest wavelets the function is constant
  Rgb average(int level, int x, int y) const;

  /// Value at a point of the unit square: the average over its finest square.
  Rgb value(float u, float v) const;

  /// The function as a map of 2^level pixels a side.
  Map reconstruct(int level) const;

private:
  /// details() of the rarer kinds of coefficients, which start at p.
  Details converted_details(const std::byte* p) const;
};

inline Details TreeView::details(std::uint32_t node) const {
  const std::size_t stride = 3 * static_cast<std::size_t>(channels) * coefficient_bytes(type);
  const std::byte* p = coefficients + node * stride;
  const Float4 rgb_scale = {scale, scale, scale, 0};
  if (channels == 3 && type == CoefficientType::Half)
    return {halves_to_floats(p) * rgb_scale, halves_to_floats(p + 6) * rgb_scale,
            halves_to_floats(p + 12) * rgb_scale};
  return converted_details(p);
}

/// A tree that owns its arrays; coefficients are padded by at least 8 bytes so that lanes may be
/// loaded.
struct Tree {
  int levels = 0;
  int channels = 3;
  CoefficientType type = CoefficientType::Half;
  float scale = 1;
  Rgb mean = Rgb::Zero();
  std::vector<std::uint32_t> level_begin; ///< levels + 1 entries: first node of each level
  std::vector<std::uint32_t> links;
  std::vector<std::byte> coefficients;

  TreeView view() const;
};

} // namespace haarlight::wavelet
