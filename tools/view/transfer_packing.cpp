#include <view/transfer_packing.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace haarlight::view {

using renderer::FilmPoint;
using wavelet::Details;
using wavelet::TreeView;

namespace {

using DetailTexel = std::array<std::uint32_t, 4>;

/// The largest number of ten bits.
constexpr float largest = 511;

float largest_of(const Details& d) {
  float result = 0;
  for (int c = 0; c < 3; ++c)
    result = std::max({result, std::abs(d.d1[c]), std::abs(d.d2[c]), std::abs(d.d3[c])});
  return result;
}

std::uint32_t ten_bits(float value) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(value, -largest, largest))) & 1023U;
}

std::uint32_t packed_rgb(Float4 d) {
  return ten_bits(d[0]) | ten_bits(d[1]) << 10U | ten_bits(d[2]) << 20U;
}

DetailTexel texel_of(const Details& d, float unit, std::uint32_t last) {
  const float per_unit = unit > 0 ? 1 / unit : 0;
  return {packed_rgb(d.d1 * per_unit), packed_rgb(d.d2 * per_unit), packed_rgb(d.d3 * per_unit),
          last};
}

/// Exponent e of the unit 2^(e - 127) in which the largest is below 512.
int exponent_for(float value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return std::clamp(exponent - 9 + 127, 1, 250);
}

DetailTexel transfer_texel(const Details& d, std::uint32_t square) {
  const int e = exponent_for(largest_of(d));
  return texel_of(d, std::ldexp(1.0F, e - 127), square << 8U | static_cast<std::uint32_t>(e));
}

DetailTexel light_texel(const Details& d) {
  const float unit = std::max(largest_of(d) / largest, 1e-36F);
  return texel_of(d, unit, std::bit_cast<std::uint32_t>(unit));
}

/// Appends a tree's nodes; children follow in the order in which they are found.
void append(const TreeView& tree, std::vector<DetailTexel>& texels) {
  std::vector<std::uint32_t> squares = {0};
  for (std::uint32_t node = 0; node < tree.node_count; ++node) {
    for (unsigned q = 0; q < 4; ++q)
      if ((tree.links[node] >> q & 1U) != 0)
        squares.push_back(4 * squares[node] + 1 + q);
    texels.push_back(transfer_texel(tree.details(node), squares[node]));
  }
}

void check_nodes(std::span<const TreeView> trees) {
  std::uint64_t nodes = 0;
  for (const TreeView& tree : trees)
    nodes += tree.node_count;
  if (nodes >= 1U << 31U)
    throw_output_error("GL", "transfer of " + std::to_string(nodes) +
                                 " nodes is to be shown; 2^31 - 1 are possible");
}

PackedTexture in_rows(const char* sampler, std::vector<DetailTexel>& texels) {
  const std::size_t rows = texels.size() / texels_per_row + 1;
  texels.resize(rows * texels_per_row);
  return packed_texture(sampler, Texel::Rgba32Ui, texels_per_row, static_cast<int>(rows), texels);
}

} // namespace

PackedScene pack_transfer(std::span<const TreeView> trees, std::span<const FilmPoint> points,
                          int width, int height) {
  check_nodes(trees);
  std::vector<DetailTexel> texels;
  std::vector<std::uint32_t> firsts;
  std::vector<float> pixels;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const TreeView& tree = trees[i];
    firsts.push_back(static_cast<std::uint32_t>(texels.size()));
    pixels.insert(pixels.end(),
                  {tree.mean[0], tree.mean[1], tree.mean[2],
                   points[i].hit.object < 0 ? -1.0F : static_cast<float>(tree.node_count)});
    append(tree, texels);
  }
  PackedScene packed;
  packed.textures = {in_rows("transfer", texels),
                     packed_texture("firsts", Texel::R32Ui, width, height, firsts),
                     packed_texture("pixels", Texel::Rgba32F, width, height, pixels)};
  return packed;
}

PackedScene pack_coefficients(const wavelet::DenseCoefficients& light) {
  std::vector<DetailTexel> texels;
  for (const Details& d : light.details())
    texels.push_back(light_texel(d));
  const Rgb mean = light.mean();
  PackedScene packed;
  packed.textures = {in_rows("light_differences", texels)};
  packed.floats = {{"light_mean", {mean[0], mean[1], mean[2]}}};
  return packed;
}

} // namespace haarlight::view
