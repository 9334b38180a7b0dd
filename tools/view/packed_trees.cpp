#include <view/packing.h>

#include <wavelet/base/error.h>
#include <wavelet/base/half.h>
#include <wavelet/tree/pyramid.h>

#include <algorithm>
#include <cmath>

namespace haarlight::view {

using wavelet::Details;
using wavelet::Map;
using wavelet::Pyramid;
using wavelet::TreeView;

namespace {

float largest_value(const Map& map) {
  float largest = 0;
  for (const float value : map.rgb)
    largest = std::max(largest, std::abs(value));
  return largest;
}

/// The tree's own scale for half coefficients, so that they are stored unchanged.
float scale_of(const TreeView& tree) {
  if (tree.type == wavelet::CoefficientType::Half)
    return tree.scale;
  float largest = 0;
  for (std::uint32_t node = 0; node < tree.node_count; ++node)
    largest = std::max(largest, largest_detail(tree.details(node)));
  return half_unit(largest);
}

void put_texel(std::uint16_t* texel, Float4 value, float unit) {
  for (int c = 0; c < 3; ++c)
    texel[c] = wavelet::float_to_half(std::clamp(value[c] / unit, -65504.0F, 65504.0F));
}

void put_dense_level(const Map& map, std::uint16_t* slice, float unit) {
  const int size = map.size;
  const int x0 = size == dense_side ? 0 : dense_side;
  const int y0 = size == dense_side ? 0 : dense_side - 2 * size;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      put_texel(slice + 4 * ((y0 + y) * slice_width + x0 + x), wavelet::to_lanes(map.at(x, y)),
                unit);
}

/// The node of a square of dense_level plus 1, or 0.
std::uint32_t subtree_root(const TreeView& tree, int x, int y) {
  std::uint32_t node = tree.root();
  for (int l = dense_level - 1; l >= 0 && node != wavelet::no_node; --l)
    node = tree.child(node, static_cast<unsigned>(((x >> l) & 1) | (((y >> l) & 1) << 1)));
  return node + 1;
}

std::uint32_t node_count(std::span<const TreeView> trees) {
  std::uint64_t nodes = 0;
  for (const TreeView& tree : trees)
    nodes += tree.node_count;
  if (nodes >= 1U << 28U)
    throw_output_error("GL", "the trees have " + std::to_string(nodes) +
                                 " nodes; at most 2^28 - 1 can be shown");
  return static_cast<std::uint32_t>(nodes);
}

TextureData pack_coarse_averages(std::span<const TreeView> trees, float unit) {
  constexpr std::size_t slice_size =
      4 * static_cast<std::size_t>(slice_width) * static_cast<std::size_t>(slice_height);
  std::vector<std::uint16_t> texels(slice_size * trees.size());
  for (std::size_t column = 0; column < trees.size(); ++column)
    for (int level = 0; level <= dense_level; ++level)
      put_dense_level(trees[column].reconstruct(level), texels.data() + slice_size * column, unit);
  TextureData result =
      texture_data("coarse_averages", TexelFormat::Rgba16F, slice_width, slice_height, texels);
  result.depth = static_cast<int>(trees.size());
  return result;
}

/// The square at (x, y) of a level, or one step outside: across an edge of the octahedral map lies
/// the same edge, mirrored. Beyond the finest level of the tree deviations are extrapolated from
/// the level above, since a rotated square overlaps several squares of the tree.
Float4 lobe_square(const Pyramid& pyramid, int entry, int level, int x, int y) {
  const int last = (1 << level) - 1;
  if (x < 0 || x > last) {
    x = std::clamp(x, 0, last);
    y = last - y;
  }
  if (y < 0 || y > last) {
    y = std::clamp(y, 0, last);
    x = std::clamp(last - x, 0, last);
  }
  const int known = std::min(level, pyramid.levels());
  const float side = power_of_two(-known);
  const float u = (static_cast<float>(x >> (level - known)) + 0.5F) * side;
  const float v = (static_cast<float>(y >> (level - known)) + 0.5F) * side;
  Float4 square = pyramid.lookup(entry, known, u, v);
  if (level >= pyramid.levels() && known > 0)
    square[3] = power_of_two(known - 1 - level) * pyramid.lookup(entry, known - 1, u, v)[3];
  return square;
}

/// Appends the rows of one level of one tree.
void append_lobe_level(const Pyramid& pyramid, int entry, int level, std::vector<float>& values) {
  const int side = std::min(1 << level, window_side);
  const int first = ((1 << level) - side) / 2;
  for (int y = -1; y <= side; ++y) {
    for (int x = -1; x <= side; ++x) {
      const Float4 square = lobe_square(pyramid, entry, level, first + x, first + y);
      for (int c = 0; c < 4; ++c)
        values.push_back(std::max(square[c], 0.0F));
    }
    values.resize(values.size() + 4 * static_cast<std::size_t>(window_side - side));
  }
}

} // namespace

float largest_detail(const Details& d) {
  float largest = 0;
  for (int c = 0; c < 3; ++c)
    largest = std::max({largest, std::abs(d.d1[c]), std::abs(d.d2[c]), std::abs(d.d3[c])});
  return largest;
}

ShaderInputs pack_trees(std::span<const TreeView> trees) {
  const int columns = static_cast<int>(trees.size());
  const int rows = static_cast<int>(node_count(trees) / nodes_per_row) + 1;
  const std::size_t places =
      static_cast<std::size_t>(rows) * static_cast<std::size_t>(nodes_per_row);
  std::vector<std::uint32_t> links(places);
  std::vector<std::uint16_t> coefficients(12 * places);
  std::vector<std::uint32_t> roots;
  std::vector<float> scales;
  float largest = 0;
  std::uint32_t base = 0; // nodes of the columns before
  for (const TreeView& tree : trees) {
    largest = std::max(largest, largest_value(tree.reconstruct(dense_level)));
    for (int y = 0; y < dense_side; ++y)
      for (int x = 0; x < dense_side; ++x) {
        const std::uint32_t root = subtree_root(tree, x, y);
        roots.push_back(root > 0 ? base + root : 0);
      }
    const float scale = scale_of(tree);
    scales.push_back(scale);
    for (std::uint32_t node = 0; node < tree.node_count; ++node) {
      const std::size_t place = base + node;
      const Details d = tree.details(node);
      links[place] = tree.links[node] + (base << 4U);
      put_texel(&coefficients[12 * place], d.d1, scale);
      put_texel(&coefficients[12 * place + 4], d.d2, scale);
      put_texel(&coefficients[12 * place + 8], d.d3, scale);
    }
    base += tree.node_count;
  }
  const float unit = half_unit(largest); // averages over coarser squares are no larger
  ShaderInputs inputs;
  inputs.textures = {
      pack_coarse_averages(trees, unit),
      texture_data("subtree_roots", TexelFormat::R32Ui, dense_side * dense_side, columns, roots),
      texture_data("scales", TexelFormat::R32F, columns, 1, scales),
      texture_data("links", TexelFormat::R32Ui, nodes_per_row, rows, links),
      texture_data("coefficients", TexelFormat::Rgba16F, 3 * nodes_per_row, rows, coefficients)};
  inputs.floats = {{"coarse_unit", {unit}}};
  return inputs;
}

ShaderInputs pack_lobes(std::span<const std::span<const TreeView>> sets) {
  int levels = 0;
  for (const auto& trees : sets)
    levels = std::max(levels, std::min(trees.front().levels + 1, finest_lobe_level));
  int columns = 0;
  std::vector<float> values;
  for (const auto& trees : sets) {
    const Pyramid pyramid(trees);
    for (int entry = 0; entry < pyramid.entries(); ++entry)
      for (int level = 0; level <= levels; ++level)
        append_lobe_level(pyramid, entry, level, values);
    columns += pyramid.entries();
  }
  const float unit = half_unit(*std::max_element(values.begin(), values.end()));
  std::vector<std::uint16_t> texels(values.size());
  std::transform(values.begin(), values.end(), texels.begin(),
                 [&](float value) { return wavelet::float_to_half(value / unit); });
  TextureData lobes =
      texture_data("lobes", TexelFormat::Rgba16F, lobe_width, lobe_row(levels + 1), texels);
  lobes.depth = columns;
  ShaderInputs inputs;
  inputs.textures = {std::move(lobes)};
  inputs.floats = {{"lobe_unit", {unit}}};
  inputs.integers = {{"lobe_levels", levels}};
  return inputs;
}

} // namespace haarlight::view
