#include <wavelet/transform/dense_coefficients.h>

#include <wavelet/transform/transform.h>

#include <bit>
#include <cassert>

namespace haarlight::wavelet {
namespace {

/// The even bits of a number, closed up: x of a place in Morton order, and y of half the place.
int even_bits(std::uint32_t place) {
  int result = 0;
  for (int bit = 0; place >> (2 * bit) != 0; ++bit)
    result |= static_cast<int>(place >> (2 * bit) & 1U) << bit;
  return result;
}

Float4 coefficient(const Map& transformed, int level, int x, int y, int m) {
  const float* c = transformed.rgb.data() + 3 * coefficient_index(transformed.size, level, x, y, m);
  return Float4{c[0], c[1], c[2], 0};
}

} // namespace

DenseCoefficients::DenseCoefficients(Map map)
    : m_levels(std::countr_zero(static_cast<unsigned>(map.size))) {
  haar_forward(map.rgb.data(), map.size, 3);
  m_mean = to_lanes(map.at(0, 0));
  for (int level = 0; level < m_levels; ++level) {
    const float area = power_of_two(-2 * level);
    for (std::uint32_t place = 0; place < 1U << (2 * level); ++place) {
      const int x = even_bits(place);
      const int y = even_bits(place >> 1U);
      m_details.push_back({coefficient(map, level, x, y, 1) * area,
                           coefficient(map, level, x, y, 2) * area,
                           coefficient(map, level, x, y, 3) * area});
    }
  }
}

void DenseCoefficients::inner_products(std::span<const TreeView> trees, std::span<Rgb> out) const {
  assert(trees.size() == out.size());
  std::vector<std::uint32_t> squares;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    assert(trees[i].levels <= m_levels);
    out[i] = to_rgb(to_lanes(trees[i].mean) * m_mean + detail_product(trees[i], squares));
  }
}

/// Nodes lie breadth first, so that the squares of children follow in the order they are found.
Float4 DenseCoefficients::detail_product(const TreeView& tree,
                                         std::vector<std::uint32_t>& squares) const {
  if (squares.size() < tree.node_count + 4)
    squares.resize(2 * tree.node_count + 4);
  std::uint32_t* const square = squares.data();
  std::uint32_t found = 1;
  square[0] = 0;
  Float4 sum = {};
  for (std::uint32_t node = 0; node < tree.node_count; ++node) {
    const std::uint32_t mask = tree.links[node] & 15U;
    for (unsigned q = 0; q < 4; ++q) { // past the end at most three that are not taken
      square[found] = 4 * square[node] + 1 + q;
      found += mask >> q & 1U;
    }
    const Details t = tree.details(node);
    const Details& f = m_details[square[node]];
    sum += t.d1 * f.d1 + t.d2 * f.d2 + t.d3 * f.d3;
  }
  return sum;
}

} // namespace haarlight::wavelet
