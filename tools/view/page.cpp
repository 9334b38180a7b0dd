#include <view/page.h>

#include <html/base64.h>
#include <view/shaders.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

namespace haarlight::view {

using Json = nlohmann::ordered_json;

namespace {

const char* name_of(Texel texel) {
  constexpr std::array<const char*, 4> names = {"R32F", "Rgba32F", "Rgba16F", "R32Ui"};
  return names[static_cast<std::size_t>(texel)];
}

Json json_of(const PackedTexture& texture) {
  return {{"sampler", texture.sampler},
          {"texel", name_of(texture.texel)},
          {"width", texture.width},
          {"height", texture.height},
          {"depth", texture.depth},
          {"mips", texture.mips},
          {"bytes", html::base64(texture.bytes)}};
}

Json list(const float* values, int count) { return std::vector<float>(values, values + count); }

Json json_of(const renderer::CameraDescription& camera) {
  const bool parallel = camera.projection == renderer::CameraProjection::Orthographic;
  return {{"projection", parallel ? "orthographic" : "perspective"},
          {"from", list(camera.from.data(), 3)},
          {"to", list(camera.to.data(), 3)},
          {"up", list(camera.up.data(), 3)},
          {"fov", camera.fov},
          {"height", camera.height}};
}

Json json_of(const Lamp& lamp) {
  return {{"at_point", lamp.at_point},
          {"place", list(lamp.place.data(), 3)},
          {"irradiance", list(lamp.irradiance.data(), 3)}};
}

void add(const PackedScene& packed, Json& page) {
  for (const PackedTexture& texture : packed.textures)
    page["textures"].push_back(json_of(texture));
  for (const auto& [name, values] : packed.floats)
    page["floats"][name] = values;
  for (const auto& [name, value] : packed.integers)
    page["integers"][name] = value;
}

/// What may change before the trees.
Json json_of(const PageOptions& options) {
  return {{"title", options.title},
          {"provenance", options.provenance},
          {"width", options.film.width},
          {"height", options.film.height},
          {"camera", json_of(options.film.camera)},
          {"lighting", options.light ? "environment" : "lamp"},
          {"lamp", json_of(options.lamp)},
          {"to_world", list(options.to_world.data(), 9)},
          {"background", options.film.light.background},
          {"level", options.level},
          {"tolerance", options.tolerance},
          {"exposure", options.exposure}};
}

/// No end of a script within it.
std::string text_of(const Json& json) {
  std::string text = json.dump();
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 2))
    text.insert(at + 1, 1, '\\');
  return text;
}

void replace(std::string& page, const std::string& mark, const std::string& text) {
  page.replace(page.find(mark), mark.size(), text);
}

} // namespace

std::string view_page(const ViewScene& scene, const PageOptions& options) {
  Json json = json_of(options);
  json["shaders"] = {{"cover", covering_vertex_shader()},
                     {"lamp", lamp_fragment_shader()},
                     {"show", show_fragment_shader()}};
  int levels = scene.levels();
  add(pack_scene(scene), json);
  if (options.light) {
    json["shaders"]["environment"] = environment_fragment_shader();
    add(pack_reflectances(scene), json);
    add(pack_light_textures(*options.light), json);
    levels = std::max(levels, options.light->levels);
  }
  json["levels"] = levels;
  if (!options.reference.empty())
    json["reference"] = html::base64(std::as_bytes(std::span(options.reference)));
  std::string page = page_html();
  replace(page, "/*SCRIPT*/", page_script());
  replace(page, "/*SCENE*/", text_of(json));
  return page;
}

} // namespace haarlight::view
