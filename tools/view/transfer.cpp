#include <view/transfer.h>

#include <wavelet/base/error.h>
#include <wavelet/base/parallel.h>

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

/// The largest signed ten-bit integer.
constexpr float largest_ten_bits = 511;

std::uint32_t ten_bits(float value) {
  return static_cast<std::uint32_t>(
             std::lround(std::clamp(value, -largest_ten_bits, largest_ten_bits))) &
         1023U;
}

std::uint32_t packed_rgb(Float4 d) {
  return ten_bits(d[0]) | ten_bits(d[1]) << 10U | ten_bits(d[2]) << 20U;
}

DetailTexel detail_texel(const Details& d, float unit, std::uint32_t last) {
  const float per_unit = unit > 0 ? 1 / unit : 0;
  return {packed_rgb(d.d1 * per_unit), packed_rgb(d.d2 * per_unit), packed_rgb(d.d3 * per_unit),
          last};
}

/// Exponent e of the unit 2^(e - 127) in which `value` is below 512.
int exponent_for(float value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return std::clamp(exponent - 9 + 127, 1, 250);
}

DetailTexel transfer_texel(const Details& d, std::uint32_t square) {
  const int e = exponent_for(largest_detail(d));
  return detail_texel(d, std::ldexp(1.0F, e - 127), square << 8U | static_cast<std::uint32_t>(e));
}

/// Appends a tree's nodes, parents before children.
void append_nodes(const TreeView& tree, std::vector<DetailTexel>& texels) {
  std::vector<std::uint32_t> squares = {0};
  for (std::uint32_t node = 0; node < tree.node_count; ++node) {
    for (unsigned q = 0; q < 4; ++q)
      if ((tree.links[node] >> q & 1U) != 0)
        squares.push_back(4 * squares[node] + 1 + q);
    texels.push_back(transfer_texel(tree.details(node), squares[node]));
  }
}

void check_transfer_nodes(std::span<const TreeView> trees) {
  std::uint64_t nodes = 0;
  for (const TreeView& tree : trees)
    nodes += tree.node_count;
  if (nodes >= 1U << 31U)
    throw_output_error("GL", "the transfer has " + std::to_string(nodes) +
                                 " nodes; at most 2^31 - 1 can be shown");
}

TextureData in_rows(const char* sampler, std::vector<DetailTexel>& texels) {
  const std::size_t rows = texels.size() / texels_per_row + 1;
  texels.resize(rows * texels_per_row);
  return texture_data(sampler, TexelFormat::Rgba32Ui, texels_per_row, static_cast<int>(rows),
                      texels);
}

} // namespace

ShaderInputs pack_transfer(std::span<const TreeView> trees, std::span<const FilmPoint> points,
                           int width, int height) {
  check_transfer_nodes(trees);
  std::vector<DetailTexel> texels;
  std::vector<std::uint32_t> firsts;
  std::vector<float> pixels;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const TreeView& tree = trees[i];
    firsts.push_back(static_cast<std::uint32_t>(texels.size()));
    pixels.insert(pixels.end(),
                  {tree.mean[0], tree.mean[1], tree.mean[2],
                   points[i].hit.object < 0 ? -1.0F : static_cast<float>(tree.node_count)});
    append_nodes(tree, texels);
  }
  ShaderInputs inputs;
  inputs.textures = {in_rows("transfer", texels),
                     texture_data("firsts", TexelFormat::R32Ui, width, height, firsts),
                     texture_data("pixels", TexelFormat::Rgba32F, width, height, pixels)};
  return inputs;
}

ShaderInputs pack_light_coefficients(const wavelet::DenseCoefficients& light) {
  std::vector<DetailTexel> texels;
  for (const Details& d : light.details()) {
    const float unit = std::max(largest_detail(d) / largest_ten_bits, 1e-36F);
    texels.push_back(detail_texel(d, unit, std::bit_cast<std::uint32_t>(unit)));
  }
  const Rgb mean = light.mean();
  ShaderInputs inputs;
  inputs.textures = {in_rows("light_differences", texels)};
  inputs.floats = {{"light_mean", {mean[0], mean[1], mean[2]}}};
  return inputs;
}

TransferLight::TransferLight(const renderer::Transfer& transfer,
                             const renderer::SceneDescription& scene,
                             const std::vector<FilmPoint>& points)
    : m_width(transfer.width()), m_height(transfer.height()), m_visible(scene.light.background),
      m_light(scene.light, renderer::SourceLookups().probe), m_map(m_light, transfer.resolution()),
      m_points(points) {}

ShaderInputs TransferLight::rotated(const Eigen::Matrix3f& rotation) const {
  ShaderInputs inputs = pack_light_coefficients(wavelet::DenseCoefficients(m_map.map(rotation)));
  inputs.textures.push_back(background(rotation));
  return inputs;
}

TextureData TransferLight::background(const Eigen::Matrix3f& rotation) const {
  std::vector<float> rgba(4 * m_points.size());
  const Eigen::Matrix3f inverse = rotation.transpose();
  parallel_ranges(m_points.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (m_visible && m_points[i].hit.object < 0)
        Eigen::Map<Rgb>(rgba.data() + 4 * i) =
            m_light.radiance(m_light.to_light(inverse * -m_points[i].wo));
  });
  return texture_data("background", TexelFormat::Rgba32F, m_width, m_height, rgba);
}

} // namespace haarlight::view
