#include "scene/scene_material.h"

namespace haarlight::renderer::detail {
namespace {

std::string plain(double value) {
  const std::string text = std::to_string(value);
  const std::size_t last = text.find_last_not_of('0');
  return text.substr(0, text[last] == '.' ? last : last + 1);
}

/// Sets a parameter if its key is there.
void read_number(const SceneNode& model, std::string_view key, double low, double high,
                 double& value) {
  const auto node = model.find(key);
  if (!node)
    return;
  value = node->number();
  if (!(value >= low && value <= high))
    node->fail("must lie between " + plain(low) + " and " + plain(high));
}

void read_colour(const SceneNode& model, std::string_view key, Rgb& value) {
  if (const auto node = model.find(key))
    value = read_albedo(*node);
}

void read_roughness(const SceneNode& node, double& roughness) {
  read_number(node, "roughness", 1e-3, 1, roughness);
}

void read_exponent(const SceneNode& node, double& exponent) {
  read_number(node, "exponent", 1e-3, 1e6, exponent);
}

void read_own(const SceneNode& node, brdf::Ggx& model) { read_roughness(node, model.roughness); }
void read_own(const SceneNode& node, brdf::Ward& model) { read_roughness(node, model.roughness); }
void read_own(const SceneNode& node, brdf::BlinnPhong& model) {
  read_exponent(node, model.exponent);
}
void read_own(const SceneNode& node, brdf::AshikhminShirley& model) {
  read_exponent(node, model.exponent);
}
void read_own(const SceneNode& node, brdf::Lafortune& model) {
  read_exponent(node, model.exponent);
  read_number(node, "lobe_xy", -10, 10, model.c_xy);
  read_number(node, "lobe_z", -10, 10, model.c_z);
  if (model.c_xy == 0 && model.c_z == 0)
    node.fail("lobe_xy and lobe_z must not both be zero");
}

template <class M>
brdf::AnalyticBrdf read(const SceneNode& node) {
  M model;
  read_colour(node, "diffuse", model.diffuse);
  read_colour(node, "specular", model.specular);
  read_own(node, model);
  return model;
}

/// What a model is called, the keys it has besides its colours, and how it is read.
struct ModelReader {
  std::string_view name;
  Names keys;
  brdf::AnalyticBrdf (*read)(const SceneNode&);
};

const std::vector<ModelReader>& model_readers() {
  static const std::vector<ModelReader> readers = {
      {"ggx", {"roughness"}, read<brdf::Ggx>},
      {"blinn-phong", {"exponent"}, read<brdf::BlinnPhong>},
      {"ward", {"roughness"}, read<brdf::Ward>},
      {"lafortune", {"exponent", "lobe_xy", "lobe_z"}, read<brdf::Lafortune>},
      {"ashikhmin-shirley", {"exponent"}, read<brdf::AshikhminShirley>}};
  return readers;
}

} // namespace

Rgb read_albedo(const SceneNode& node) {
  Rgb albedo = node.vector().array();
  if ((albedo < 0).any() || (albedo > 1).any())
    node.fail("must hold albedos between 0 and 1");
  return albedo;
}

Rgb read_emission(const SceneNode& node) {
  Rgb emission = node.vector().array();
  if ((emission < 0).any())
    node.fail("must hold radiances, none below 0");
  return emission;
}

Names model_names() {
  Names names;
  for (const ModelReader& reader : model_readers())
    names.push_back(reader.name);
  return names;
}

std::string joined(const Names& names) {
  std::string text;
  for (const std::string_view name : names)
    text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

std::optional<brdf::AnalyticBrdf> read_model(const SceneNode& material) {
  for (const ModelReader& reader : model_readers())
    if (const auto node = material.find(reader.name)) {
      Names keys = {"diffuse", "specular"};
      keys.insert(keys.end(), reader.keys.begin(), reader.keys.end());
      node->allow(keys);
      return reader.read(*node);
    }
  return std::nullopt;
}

} // namespace haarlight::renderer::detail
