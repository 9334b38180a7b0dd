#include <view/packed_scene.h>

#include <view/packed_lobes.h>
#include <view/packed_trees.h>

#include <wavelet/base/error.h>

#include <algorithm>
#include <cstring>
#include <span>

namespace haarlight::view {

using namespace renderer;

namespace {

template <class T>
void append(std::vector<std::byte>& bytes, const std::vector<T>& values) {
  const auto from = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), from.begin(), from.end());
}

template <class T>
PackedTexture texture(const char* sampler, Texel texel, int width, int height,
                      const std::vector<T>& values) {
  PackedTexture result = {sampler, texel, width, height, 0, false, {}};
  append(result.bytes, values);
  return result;
}

PackedTexture filtered(const char* sampler, int width, int height, int depth,
                       const std::vector<std::uint16_t>& halves) {
  PackedTexture result = texture(sampler, Texel::Rgba16F, width, height, halves);
  result.depth = depth;
  return result;
}

/// The two texels of each object that scene.glsl reads.
std::vector<float> object_texels(const ViewScene& scene) {
  const ShapeSet& shapes = scene.shapes();
  std::vector<float> texels(8 * static_cast<std::size_t>(shapes.size()));
  const auto put = [&](int object, const Eigen::Vector3d& v, double w, float kind) {
    const Columns& columns = scene.columns_of(object);
    const float both[8] = {static_cast<float>(v.x()),
                           static_cast<float>(v.y()),
                           static_cast<float>(v.z()),
                           static_cast<float>(w),
                           kind,
                           static_cast<float>(columns.first),
                           static_cast<float>(columns.count),
                           static_cast<float>(columns.levels)};
    std::copy(both, both + 8, &texels[8 * static_cast<std::size_t>(object)]);
  };
  for (const detail::Solid& solid : shapes.solids())
    put(solid.object, solid.center, solid.radius, 0);
  for (const detail::WorldPlane& plane : shapes.planes())
    put(plane.object, plane.normal, plane.height, 1);
  return texels;
}

void check_nodes(const std::vector<wavelet::TreeView>& trees) {
  std::uint64_t nodes = 0;
  for (const wavelet::TreeView& tree : trees)
    nodes += tree.node_count;
  if (nodes >= 1U << 28U)
    throw_output_error("GL", "trees of " + std::to_string(nodes) +
                                 " nodes are to be shown; 2^28 - 1 are possible");
}

void add_objects(const ViewScene& scene, PackedScene& packed) {
  const int count = scene.shapes().size();
  packed.textures.push_back(
      texture("objects", Texel::Rgba32F, 2, std::max(count, 1), object_texels(scene)));
  packed.integers.emplace_back("object_count", count);
}

} // namespace

PackedScene pack_scene(const ViewScene& scene) {
  check_nodes(scene.trees());
  const PackedTrees trees = pack_trees(scene.trees());
  PackedScene packed;
  packed.textures = {
      filtered("tops", slice_width, slice_height, trees.columns, trees.tops),
      texture("starts", Texel::R32Ui, top_side * top_side, trees.columns, trees.starts),
      texture("scales", Texel::R32F, trees.columns, 1, trees.scales),
      texture("links", Texel::R32Ui, nodes_per_row, trees.node_rows, trees.links),
      texture("coefficients", Texel::Rgba16F, 3 * nodes_per_row, trees.node_rows,
              trees.coefficients)};
  packed.floats = {{"top_unit", {trees.top_unit}}};
  add_objects(scene, packed);
  return packed;
}

PackedScene pack_reflectances(const ViewScene& scene) {
  std::vector<std::span<const wavelet::TreeView>> sets;
  for (const Columns& columns : scene.columns())
    sets.push_back(std::span(scene.trees())
                       .subspan(static_cast<std::size_t>(columns.first),
                                static_cast<std::size_t>(columns.count)));
  const PackedLobes lobes = pack_lobes(sets);
  PackedScene packed;
  packed.textures = {
      filtered("lobes", lobe_width, lobe_row(lobes.levels + 1), lobes.columns, lobes.texels)};
  packed.floats = {{"lobe_unit", {lobes.unit}}};
  packed.integers = {{"lobe_levels", lobes.levels}};
  return packed;
}

PackedScene pack_light_textures(const PackedLight& light) {
  const int side = 1 << light.levels;
  PackedTexture radiance = {"light_squares", Texel::Rgba16F, side, side, 0, true, {}};
  PackedTexture directions = radiance;
  directions.sampler = "light_directions";
  for (auto level = light.squares.rbegin(); level != light.squares.rend(); ++level) {
    append(radiance.bytes, level->radiance);
    append(directions.bytes, level->directions);
  }
  PackedScene packed;
  packed.textures = {std::move(radiance), std::move(directions)};
  packed.floats = {{"light_unit", {light.unit}}};
  packed.integers = {{"light_levels", light.levels}};
  return packed;
}

} // namespace haarlight::view
