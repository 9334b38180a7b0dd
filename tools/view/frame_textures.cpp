#include <view/frame.h>

#include <view/packed_lobes.h>
#include <view/packed_trees.h>

#include <wavelet/error.h>

#include <algorithm>
#include <span>
#include <utility>

namespace haarlight::view {

using namespace renderer;

namespace {

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

} // namespace

void FrameDrawer::put(const std::string& name, Texture texture, std::size_t bytes) {
  for (Named& old : m_textures)
    if (old.name == name) {
      old.texture = std::move(texture);
      old.bytes = bytes;
      return;
    }
  m_textures.push_back({name, std::move(texture), bytes});
}

std::size_t FrameDrawer::texture_bytes() const {
  std::size_t bytes = 0;
  for (const Named& named : m_textures)
    bytes += named.bytes;
  return bytes;
}

void FrameDrawer::add_trees(const ViewScene& scene) {
  check_nodes(scene.trees());
  const PackedTrees packed = pack_trees(scene.trees());
  put("tops", Texture(slice_width, slice_height, packed.columns, packed.tops.data()),
      2 * packed.tops.size());
  put("starts", Texture(Texel::R32Ui, top_side * top_side, packed.columns, packed.starts.data()),
      4 * packed.starts.size());
  put("scales", Texture(Texel::R32F, packed.columns, 1, packed.scales.data()),
      4 * packed.scales.size());
  put("links", Texture(Texel::R32Ui, nodes_per_row, packed.node_rows, packed.links.data()),
      4 * packed.links.size());
  put("coefficients",
      Texture(Texel::Rgba16F, 3 * nodes_per_row, packed.node_rows, packed.coefficients.data()),
      2 * packed.coefficients.size());
  set("top_unit", std::vector<float>{packed.top_unit});
}

void FrameDrawer::add_lobes(const ViewScene& scene) {
  std::vector<std::span<const wavelet::TreeView>> sets;
  for (const Columns& columns : scene.columns())
    sets.push_back(std::span(scene.trees())
                       .subspan(static_cast<std::size_t>(columns.first),
                                static_cast<std::size_t>(columns.count)));
  const PackedLobes packed = pack_lobes(sets);
  put("lobes",
      Texture(lobe_width, lobe_row(packed.levels + 1), packed.columns, packed.texels.data()),
      2 * packed.texels.size());
  set("lobe_levels", packed.levels);
  set("lobe_unit", std::vector<float>{packed.unit});
}

void FrameDrawer::add_objects(const ViewScene& scene) {
  const int count = scene.shapes().size();
  const std::vector<float> texels = object_texels(scene);
  put("objects",
      Texture(Texel::Rgba32F, 2, std::max(count, 1), count > 0 ? texels.data() : nullptr),
      4 * texels.size());
  set("object_count", count);
}

void FrameDrawer::set_light(const PackedLight& light) {
  std::vector<const void*> radiance;
  std::vector<const void*> directions;
  for (auto level = light.squares.rbegin(); level != light.squares.rend(); ++level) {
    radiance.push_back(level->radiance.data());
    directions.push_back(level->directions.data());
  }
  put("light_squares", Texture(Texel::Rgba16F, radiance), light.bytes() / 2);
  put("light_directions", Texture(Texel::Rgba16F, directions), light.bytes() / 2);
  set("light_levels", light.levels);
  set("light_unit", std::vector<float>{light.unit});
}

} // namespace haarlight::view
