#include <wavelet/tree/tree.h>

#include <algorithm>
#include <cassert>

namespace haarlight::wavelet {
namespace {

void fill(Map& map, int x0, int y0, int side, Float4 value) {
  const Rgb colour = to_rgb(value);
  for (int y = y0; y < y0 + side; ++y)
    for (int x = x0; x < x0 + side; ++x)
      map.set(x, y, colour);
}

void reconstruct_square(const TreeView& tree, std::uint32_t node, Float4 mean, Map& map, int x0,
                        int y0, int side) {
  if (node == no_node || side == 1) {
    fill(map, x0, y0, side, mean);
    return;
  }
  const auto children = tree.details(node).children(mean);
  const int half = side / 2;
  for (unsigned q = 0; q < 4; ++q)
    reconstruct_square(tree, tree.child(node, q), children[q], map,
                       x0 + static_cast<int>(q & 1U) * half, y0 + static_cast<int>(q >> 1U) * half,
                       half);
}

} // namespace

Details TreeView::converted_details(const std::byte* p) const {
  Details result = {};
  Float4* const d[3] = {&result.d1, &result.d2, &result.d3};
  for (int m = 0; m < 3; ++m)
    for (int c = 0; c < 3; ++c) {
      const int source = m * channels + (channels == 3 ? c : 0);
      float value = 0;
      if (type == CoefficientType::Float) {
        std::memcpy(&value, p + 4 * source, 4);
      } else {
        std::uint16_t half = 0;
        std::memcpy(&half, p + 2 * source, 2);
        value = half_to_float(half);
      }
      (*d[m])[c] = value * scale;
    }
  return result;
}

Rgb TreeView::average(int level, int x, int y) const {
  assert(level >= 0 && x >= 0 && y >= 0 && (x >> level) == 0 && (y >> level) == 0);
  Float4 result = to_lanes(mean);
  std::uint32_t node = root();
  for (int l = level - 1; l >= 0 && node != no_node; --l) {
    const auto q = static_cast<unsigned>(((x >> l) & 1) | (((y >> l) & 1) << 1));
    result = details(node).children(result)[q];
    node = child(node, q);
  }
  return to_rgb(result);
}

Rgb TreeView::value(float u, float v) const {
  const int size = 1 << levels;
  const int x = std::clamp(static_cast<int>(u * static_cast<float>(size)), 0, size - 1);
  const int y = std::clamp(static_cast<int>(v * static_cast<float>(size)), 0, size - 1);
  return average(levels, x, y);
}

Map TreeView::reconstruct(int level) const {
  assert(level >= 0 && level <= 13);
  Map map(1 << level);
  reconstruct_square(*this, root(), to_lanes(mean), map, 0, 0, map.size);
  return map;
}

TreeView Tree::view() const {
  TreeView view;
  view.levels = levels;
  view.channels = channels;
  view.type = type;
  view.node_count = static_cast<std::uint32_t>(links.size());
  view.scale = scale;
  view.mean = mean;
  view.links = links.data();
  view.coefficients = coefficients.data();
  return view;
}

} // namespace haarlight::wavelet
