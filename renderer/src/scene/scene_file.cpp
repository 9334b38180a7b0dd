// Reading scene files. renderer/SCENE.md documents the format.

#include "scene/scene_json.h"

#include <renderer/film/film.h>
#include <renderer/scene/scene.h>

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>

namespace haarlight::renderer {
namespace {

using namespace detail;

/// Sets a parameter if its key is present.
void read_number(const SceneNode& model, std::string_view key, double low, double high,
                 double& value) {
  if (const auto node = model.find(key))
    value = node->number_within(low, high);
}

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

template <class Model>
brdf::AnalyticBrdf read(const SceneNode& node) {
  Model model;
  if (const auto diffuse = node.find("diffuse"))
    model.diffuse = read_albedo(*diffuse);
  if (const auto specular = node.find("specular"))
    model.specular = read_albedo(*specular);
  if constexpr (requires { model.roughness; })
    read_number(node, "roughness", 1e-3, 1, model.roughness);
  if constexpr (requires { model.exponent; })
    read_number(node, "exponent", 1e-3, 1e6, model.exponent);
  if constexpr (std::is_same_v<Model, brdf::Lafortune>) {
    read_number(node, "lobe_xy", -10, 10, model.c_xy);
    read_number(node, "lobe_z", -10, 10, model.c_z);
    if (model.c_xy == 0 && model.c_z == 0)
      node.fail("lobe_xy and lobe_z must not both be zero");
  }
  return model;
}

/// An analytic model: its key, the keys of its parameters besides colours, and its reader.
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

Shape read_sphere(const SceneNode& node) {
  return Sphere{node.at("center").vector(), node.at("radius").positive()};
}

Shape read_plane(const SceneNode& node) {
  return Plane{node.at("point").vector(), node.at("normal").direction()};
}

Shape read_disk(const SceneNode& node) {
  return Disk{node.at("center").vector(), node.at("normal").direction(),
              node.at("radius").positive()};
}

Shape read_box(const SceneNode& node) {
  const Box box{node.at("min").vector(), node.at("max").vector()};
  if (!(box.low.array() < box.high.array()).all())
    node.at("max").fail("must be above min in x, y and z");
  return box;
}

/// Two points that must differ: the ends of a cylinder or a cone.
Vec3 read_other_end(const SceneNode& node, const char* key, const Vec3& base) {
  Vec3 end = node.at(key).vector();
  if (end == base)
    node.at(key).fail("must not be the same point as base");
  return end;
}

Shape read_cylinder(const SceneNode& node) {
  const Vec3 base = node.at("base").vector();
  return Cylinder{base, read_other_end(node, "top", base), node.at("radius").positive()};
}

Shape read_cone(const SceneNode& node) {
  const Vec3 base = node.at("base").vector();
  return Cone{base, read_other_end(node, "apex", base), node.at("radius").positive()};
}

Shape read_torus(const SceneNode& node) {
  const Torus torus{node.at("center").vector(), node.at("axis").direction(),
                    node.at("major_radius").positive(), node.at("minor_radius").positive()};
  if (!(torus.minor_radius < torus.major_radius))
    node.at("minor_radius").fail("must be below major_radius");
  return torus;
}

/// A shape type: its name, its own keys, and its reader.
struct ShapeReader {
  std::string_view type;
  Names keys;
  Shape (*read)(const SceneNode&);
};

const std::vector<ShapeReader>& shape_readers() {
  static const std::vector<ShapeReader> readers = {
      {"sphere", {"center", "radius"}, read_sphere},
      {"plane", {"point", "normal"}, read_plane},
      {"disk", {"center", "normal", "radius"}, read_disk},
      {"box", {"min", "max"}, read_box},
      {"cylinder", {"base", "top", "radius"}, read_cylinder},
      {"cone", {"base", "apex", "radius"}, read_cone},
      {"torus", {"center", "axis", "major_radius", "minor_radius"}, read_torus}};
  return readers;
}

const ShapeReader& reader_of(const SceneNode& type) {
  const std::string name = type.text();
  Names known;
  for (const ShapeReader& reader : shape_readers()) {
    if (reader.type == name)
      return reader;
    known.push_back(reader.type);
  }
  type.fail_unknown("shape", name, known);
}

Eigen::Vector3d to_vector(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

AffineMap read_rotation(const SceneNode& node) {
  if (!node.is_object())
    return euler_rotation(to_vector(node.numbers(3)));
  node.allow({"axis", "angle"});
  return rotation(node.at("axis").direction().cast<double>(), node.at("angle").number());
}

AffineMap read_scaling(const SceneNode& node) {
  const Eigen::Vector3d factors =
      node.is_number() ? Eigen::Vector3d::Constant(node.number()) : to_vector(node.numbers(3));
  if ((factors.array() == 0).any())
    node.fail("must not be zero");
  return scaling(factors);
}

AffineMap read_matrix(const SceneNode& node) {
  const std::vector<double> m = node.numbers(16);
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    node.fail("must end with the row 0, 0, 0, 1");
  AffineMap result;
  result.linear << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  result.offset << m[3], m[7], m[11];
  return result;
}

AffineMap read_step(const SceneNode& node) {
  const Names known = {"translate", "rotate", "scale", "matrix"};
  node.allow(known);
  if (node.keys().size() != 1)
    node.fail("must hold exactly one of translate, rotate, scale, matrix; put several steps in an "
              "array, in the order they apply");
  if (const auto step = node.find("translate"))
    return translation(to_vector(step->numbers(3)));
  if (const auto step = node.find("rotate"))
    return read_rotation(*step);
  if (const auto step = node.find("scale"))
    return read_scaling(*step);
  return read_matrix(node.at("matrix"));
}

AffineMap read_transform(const SceneNode& node) {
  AffineMap result;
  if (node.is_object())
    result = read_step(node);
  else
    for (const SceneNode& step : node.elements())
      result = result.then(read_step(step));
  if (!result.usable())
    node.fail("cannot be inverted within the range of numbers: flattens, or scales too far");
  return result;
}

ObjectDescription read_object(const SceneNode& node) {
  const ShapeReader& reader = reader_of(node.at("type"));
  Names keys = {"type", "material", "transform", "name"};
  keys.insert(keys.end(), reader.keys.begin(), reader.keys.end());
  node.allow(keys);
  ObjectDescription object;
  object.shape = reader.read(node);
  if (const auto transform = node.find("transform"))
    object.transform = read_transform(*transform);
  return object;
}

constexpr std::size_t scene_bytes_max = std::size_t{1} << 26;

/// File names of a scene are relative to its folder.
class Folder {
public:
  explicit Folder(const std::string& scene_path)
      : m_prefix(names_descriptor(scene_path) ? "./"
                                              : scene_path.substr(0, scene_path.rfind('/') + 1)) {}

  /// The file name of a key; empty if the key is absent.
  std::string file(const SceneNode& node, std::string_view key) const {
    const auto name = node.find(key);
    if (!name)
      return {};
    const std::string text = name->text();
    const std::string path = text.front() == '/' ? text : m_prefix + text;
    return path == "-" ? "./-" : path; // a scene cannot name standard input
  }

private:
  std::string m_prefix;
};

void read_film(const SceneNode& node, SceneDescription& scene) {
  node.allow({"width", "height"});
  const long long width = node.at("width").whole_number();
  const long long height = node.at("height").whole_number();
  const std::string problem = validate_film_size(width, height);
  if (!problem.empty())
    node.fail(problem);
  scene.width = static_cast<int>(width);
  scene.height = static_cast<int>(height);
}

void refuse_degenerate_view(const SceneNode& node, const CameraDescription& camera) {
  const Eigen::Vector3d view = (camera.to.cast<double>() - camera.from.cast<double>());
  if (view.stableNorm() <= 1e-6 * camera.from.cast<double>().stableNorm())
    node.at("to").fail("must not be the same point as from");
  const Eigen::Vector3d across =
      view.stableNormalized().cross(camera.up.cast<double>().stableNormalized());
  if (across.norm() < 1e-4)
    node.fail("up must not be parallel to the view from 'from' to 'to'");
}

void read_projection(const SceneNode& node, CameraDescription& camera) {
  const std::string type = node.at("type").choice("camera", {"perspective", "orthographic"});
  if (type == "orthographic") {
    node.allow({"type", "from", "to", "up", "height"});
    camera.projection = CameraProjection::Orthographic;
    camera.height = node.at("height").positive();
    return;
  }
  node.allow({"type", "from", "to", "up", "fov"});
  camera.fov = node.at("fov").number();
  if (!(camera.fov >= 0.001 && camera.fov <= 179))
    node.at("fov").fail("must lie between 0.001 and 179 degrees");
}

CameraDescription read_camera(const SceneNode& node) {
  CameraDescription camera;
  read_projection(node, camera);
  camera.from = node.at("from").vector();
  camera.to = node.at("to").vector();
  if (const auto up = node.find("up"))
    camera.up = up->direction();
  refuse_degenerate_view(node, camera);
  return camera;
}

LightDescription read_light(const SceneNode& node, const Folder& folder) {
  node.allow({"probe", "layer", "part", "haar", "table", "mapping", "rotate", "background"});
  LightDescription light;
  light.probe = folder.file(node, "probe");
  light.haar = folder.file(node, "haar");
  light.table = folder.file(node, "table");
  if (light.probe.empty() && light.haar.empty() && light.table.empty())
    node.fail("needs at least one of the keys probe, haar, table");
  for (const auto& [key, text] : {std::pair("layer", &light.layer), std::pair("part", &light.part)})
    if (const auto choice = node.find(key)) {
      if (light.probe.empty())
        choice->fail("belongs to a \"probe\", which is missing");
      *text = choice->text();
    }
  if (const auto mapping = node.find("mapping"))
    light.mapping =
        mapping->choice("mapping", {"auto", "angular", "latlong", "mirrorball", "octahedral"});
  if (const auto rotate = node.find("rotate"))
    light.rotate = rotate->number();
  if (const auto background = node.find("background"))
    light.background = background->boolean();
  return light;
}

MaterialDescription read_material(const SceneNode& node, const std::string& name,
                                  const Folder& folder) {
  Names keys = {"brdf", "haar", "table", "lambert", "emission"};
  const Names models = model_names();
  keys.insert(keys.end(), models.begin(), models.end());
  node.allow(keys);
  MaterialDescription material;
  material.name = name;
  material.brdf = folder.file(node, "brdf");
  material.haar = folder.file(node, "haar");
  material.table = folder.file(node, "table");
  if (const auto lambert = node.find("lambert"))
    material.lambert = read_albedo(*lambert);
  material.model = read_model(node);
  if (const auto emission = node.find("emission"))
    material.emission = read_emission(*emission);
  if (node.keys().empty())
    node.fail("needs at least one of the keys brdf, haar, table, or lambert, or a model: " +
              joined(models) + "; or emission");
  const std::size_t reflectances = node.keys().size() - (node.has("emission") ? 1 : 0);
  if ((material.lambert || material.model) && reflectances > 1)
    node.fail(std::string(material.lambert ? "lambert" : "a model") +
              " stands alone, without brdf, haar, table or another model");
  return material;
}

std::vector<MaterialDescription> read_materials(const SceneNode& node, const Folder& folder) {
  std::vector<MaterialDescription> materials;
  const std::vector<std::string>& names = node.keys();
  for (const SceneNode& element : node.elements())
    materials.push_back(read_material(element, names[materials.size()], folder));
  return materials;
}

std::vector<std::string> read_object_names(const SceneNode& node) {
  std::vector<std::string> names;
  std::map<std::string, std::size_t> index;
  for (const SceneNode& element : node.elements()) {
    const auto name = element.find("name");
    names.push_back(name ? name->text() : "");
    if (!name)
      continue;
    const auto [first, is_new] = index.emplace(names.back(), names.size() - 1);
    if (!is_new)
      name->fail("is already the name of objects[" + std::to_string(first->second) + "]");
  }
  return names;
}

std::vector<ObjectDescription> read_objects(const SceneNode& node,
                                            const std::vector<std::string>& materials) {
  if (!node.is_array())
    node.fail("must be an array of objects");
  const Names known(materials.begin(), materials.end());
  std::map<std::string, int> index;
  for (const std::string& name : materials)
    index.emplace(name, static_cast<int>(index.size()));
  std::vector<ObjectDescription> objects;
  for (const SceneNode& element : node.elements()) {
    objects.push_back(read_object(element));
    const SceneNode material = element.at("material");
    const auto found = index.find(material.text());
    if (found == index.end())
      material.fail_unknown("material", material.text(), known);
    objects.back().material = found->second;
  }
  return objects;
}

} // namespace

SceneDescription load_scene(const std::string& path) {
  const InputFile file(path);
  if (file.size() > scene_bytes_max)
    throw_input_error(path, "is larger than 64 MiB, the limit for scene files");
  const Json value = parse_json(file.bytes(), path);
  const SceneNode root(value, "", path);
  root.allow({"film", "camera", "light", "materials", "objects"});
  const Folder folder(path);
  SceneDescription scene;
  scene.path = path;
  scene.hash = hash_text(file.bytes());
  read_film(root.at("film"), scene);
  scene.camera = read_camera(root.at("camera"));
  scene.light = read_light(root.at("light"), folder);
  scene.materials = read_materials(root.at("materials"), folder);
  scene.objects = read_objects(root.at("objects"), root.at("materials").keys());
  scene.object_names = read_object_names(root.at("objects"));
  return scene;
}

} // namespace haarlight::renderer
