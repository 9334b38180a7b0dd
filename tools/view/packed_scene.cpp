#include <view/packing.h>

#include <wavelet/base/half.h>
#include <wavelet/square/sphere_map.h>

#include <algorithm>
#include <cmath>

namespace haarlight::view {
namespace {

/// Sums over the light of a square: radiance, and directions with their weight.
struct LightMoments {
  Rgb radiance = Rgb::Zero();
  Vec3 directions = Vec3::Zero();
  float weight = 0;
};

using LightLevel = std::vector<LightMoments>;

std::size_t square_index(int level, int x, int y) {
  return (static_cast<std::size_t>(y) << static_cast<unsigned>(level)) +
         static_cast<std::size_t>(x);
}

/// Uniform light over each pixel. Black pixels have a small weight, so that their squares have a
/// mean direction.
LightLevel finest_light(const wavelet::Map& map, int level) {
  const float side = 1.0F / static_cast<float>(map.size);
  const float spread = uniform_spread * side;
  const float least = 1e-6F * luminance(map_mean(map).cast<float>()) + 1e-30F;
  LightLevel result(map.rgb.size() / 3);
  for (int y = 0; y < map.size; ++y)
    for (int x = 0; x < map.size; ++x) {
      LightMoments& m = result[square_index(level, x, y)];
      m.radiance = map.at(x, y);
      m.weight = luminance(m.radiance) + least;
      m.directions = m.weight * std::sqrt(std::max(0.0F, 1 - spread * spread)) *
                     wavelet::square_to_sphere(Vec2((static_cast<float>(x) + 0.5F) * side,
                                                    (static_cast<float>(y) + 0.5F) * side));
    }
  return result;
}

LightLevel coarser_light(const LightLevel& fine, int level) {
  LightLevel result(fine.size() / 4);
  for (int y = 0; y < 1 << level; ++y)
    for (int x = 0; x < 1 << level; ++x)
      for (int q = 0; q < 4; ++q) {
        const LightMoments& part = fine[square_index(level + 1, 2 * x + q % 2, 2 * y + q / 2)];
        LightMoments& sum = result[square_index(level, x, y)];
        sum.radiance += 0.25F * part.radiance;
        sum.directions += 0.25F * part.directions;
        sum.weight += 0.25F * part.weight;
      }
  return result;
}

float spread_of(const LightMoments& m) {
  const float length = m.directions.norm() / m.weight;
  return std::sqrt(std::max(0.0F, (1 - length) * (1 + length)));
}

template <class Vector>
void append_texel(std::vector<std::uint16_t>& texels, const Vector& rgb, float alpha) {
  for (int c = 0; c < 3; ++c)
    texels.push_back(wavelet::float_to_half(rgb[c]));
  texels.push_back(wavelet::float_to_half(alpha));
}

/// The two texels of each object that scene.glsl reads.
TextureData pack_objects(const ViewScene& scene) {
  const renderer::ShapeSet& shapes = scene.shapes();
  const int count = shapes.size();
  std::vector<float> texels(8 * static_cast<std::size_t>(count));
  const auto put = [&](int object, const Eigen::Vector3d& v, double w, float kind) {
    const Columns& columns = scene.columns_of(object);
    const float values[8] = {static_cast<float>(v.x()),
                             static_cast<float>(v.y()),
                             static_cast<float>(v.z()),
                             static_cast<float>(w),
                             kind,
                             static_cast<float>(columns.first),
                             static_cast<float>(columns.count),
                             static_cast<float>(columns.levels)};
    std::copy(values, values + 8, &texels[8 * static_cast<std::size_t>(object)]);
  };
  for (const renderer::detail::Solid& solid : shapes.solids())
    put(solid.object, solid.center, solid.radius, 0);
  for (const renderer::detail::WorldPlane& plane : shapes.planes())
    put(plane.object, plane.normal, plane.height, 1);
  return texture_data("objects", TexelFormat::Rgba32F, 2, std::max(count, 1), texels);
}

} // namespace

PackedLight pack_light(const wavelet::Map& map) {
  PackedLight light;
  while (1 << light.levels < map.size)
    ++light.levels;
  const float unit = half_unit(*std::max_element(map.rgb.begin(), map.rgb.end()));
  std::vector<std::uint16_t> radiance;
  std::vector<std::uint16_t> directions;
  LightLevel level = finest_light(map, light.levels);
  for (int l = light.levels; l >= 0; --l) {
    for (const LightMoments& m : level) {
      append_texel(radiance, Rgb(m.radiance / unit), spread_of(m));
      append_texel(directions, Vec3(m.directions.normalized()), 0);
    }
    if (l > 0)
      level = coarser_light(level, l - 1);
  }
  light.inputs.textures = {
      texture_data("light_squares", TexelFormat::Rgba16F, map.size, map.size, radiance),
      texture_data("light_directions", TexelFormat::Rgba16F, map.size, map.size, directions)};
  for (TextureData& texture : light.inputs.textures)
    texture.mips = true;
  light.inputs.floats = {{"light_unit", {unit}}};
  light.inputs.integers = {{"light_levels", light.levels}};
  return light;
}

ShaderInputs pack_scene(const ViewScene& scene) {
  ShaderInputs inputs = pack_trees(scene.trees());
  inputs.textures.push_back(pack_objects(scene));
  inputs.integers.emplace_back("object_count", scene.shapes().size());
  return inputs;
}

ShaderInputs pack_lobes(const ViewScene& scene) {
  std::vector<std::span<const wavelet::TreeView>> sets;
  for (const Columns& columns : scene.columns())
    sets.push_back(std::span(scene.trees())
                       .subspan(static_cast<std::size_t>(columns.first),
                                static_cast<std::size_t>(columns.count)));
  return pack_lobes(sets);
}

} // namespace haarlight::view
