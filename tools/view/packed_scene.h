#pragma once
// All that shaders read of a scene, as plain values: for textures and uniforms of whatever draws.
// No GL here.

#include <view/packed_light.h>
#include <view/view_scene.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace haarlight::view {

enum class Texel { R32F, Rgba32F, Rgba16F, R32Ui, Rgba32Ui };

struct PackedTexture {
  std::string sampler; ///< its name in the shaders
  Texel texel = Texel::R32F;
  int width = 1;
  int height = 1;
  int depth = 0;     ///< 0: 2D, read by texelFetch() alone; else 3D and filtered
  bool mips = false; ///< 2D, square: all levels, the finest first, each half as large as the last
  std::vector<std::byte> bytes; ///< row by row; empty if undefined
};

struct PackedScene {
  std::vector<PackedTexture> textures;
  std::vector<std::pair<std::string, std::vector<float>>> floats; ///< uniforms of 1 to 4
  std::vector<std::pair<std::string, int>> integers;
};

/// Shapes and trees. @throws Error(Output) if there are 2^28 nodes or more
PackedScene pack_scene(const ViewScene& scene);

/// What environment.glsl needs besides: reflectances as lobes, then the light, as often as that
/// changes.
PackedScene pack_reflectances(const ViewScene& scene);
PackedScene pack_light_textures(const PackedLight& light);

} // namespace haarlight::view
