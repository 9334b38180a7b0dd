#include <view/page.h>

#include <html/page.h>
#include <view/shaders.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace haarlight::view {

using Json = nlohmann::ordered_json;

namespace {

/// Keys of `formats` in page.js.
constexpr std::array format_names = {"R32F", "Rgba32F", "Rgba16F", "R32Ui", "Rgba32Ui"};
static_assert(format_names.size() == texel_format_count);

Json json_list(const float* values, int count) {
  return std::vector<float>(values, values + count);
}

Json camera_json(const renderer::CameraDescription& camera) {
  const bool orthographic = camera.projection == renderer::CameraProjection::Orthographic;
  return {{"projection", orthographic ? "orthographic" : "perspective"},
          {"from", json_list(camera.from.data(), 3)},
          {"to", json_list(camera.to.data(), 3)},
          {"up", json_list(camera.up.data(), 3)},
          {"fov", camera.fov},
          {"height", camera.height}};
}

Json options_json(const PageOptions& options) {
  const ViewState& state = options.state;
  return {{"provenance", options.provenance},
          {"width", state.width},
          {"height", state.height},
          {"camera", camera_json(state.camera)},
          {"lighting", state.environment ? "environment" : "punctual"},
          {"punctual",
           {{"is_point", state.punctual.is_point},
            {"place", json_list(state.punctual.place.data(), 3)},
            {"irradiance", json_list(state.punctual.irradiance.data(), 3)}}},
          {"to_world", json_list(state.to_world.data(), 9)},
          {"background", state.background},
          {"level", state.level},
          {"tolerance", state.tolerance},
          {"exposure", options.exposure}};
}

void add_inputs(const ShaderInputs& inputs, Json& page) {
  for (const TextureData& texture : inputs.textures)
    page["textures"].push_back({{"sampler", texture.sampler},
                                {"format", texel_format_name(texture.format)},
                                {"width", texture.width},
                                {"height", texture.height},
                                {"depth", texture.depth},
                                {"mips", texture.mips},
                                {"bytes", html::base64(texture.bytes)}});
  for (const auto& [name, values] : inputs.floats)
    page["floats"][name] = values;
  for (const auto& [name, value] : inputs.integers)
    page["integers"][name] = value;
}

/// The text of a JSON value that contains no "</", which would end a script element.
std::string script_text(const Json& json) {
  std::string text = json.dump();
  for (std::size_t at = text.find("</"); at != std::string::npos; at = text.find("</", at + 2))
    text.insert(at + 1, 1, '\\');
  return text;
}

} // namespace

const char* texel_format_name(TexelFormat format) {
  return format_names[static_cast<std::size_t>(format)];
}

std::string view_page(const ViewScene& scene, const PageOptions& options) {
  const PackedLight* const environment = options.state.environment.get();
  Json json = options_json(options);
  json["shaders"] = {{"full_screen", full_screen_shader()},
                     {"punctual", punctual_shader()},
                     {"tone_map", tone_map_shader()}};
  add_inputs(pack_scene(scene), json);
  int levels = scene.levels();
  if (environment != nullptr) {
    json["shaders"]["environment"] = environment_shader();
    add_inputs(pack_lobes(scene), json);
    add_inputs(environment->inputs, json);
    levels = std::max(levels, environment->levels);
  }
  json["levels"] = levels;
  if (!options.reference.empty())
    json["reference"] = html::base64(std::as_bytes(std::span(options.reference)));
  return html::document(options.title, page_style(),
                        page_body() + "<script id=\"scene\" type=\"application/json\">" +
                            script_text(json) + "</script>\n<script>\n" + page_script() +
                            "</script>\n");
}

} // namespace haarlight::view
