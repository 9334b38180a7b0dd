#include <renderer/scene/scene_file.h>

#include "scene/scene_material.h"
#include "scene/scene_object.h"

#include <renderer/film/film.h>
#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <algorithm>
#include <map>

namespace haarlight::renderer {

using namespace detail;

namespace {

constexpr std::size_t scene_bytes_max = std::size_t{1} << 26;

/// File names of a scene count from its folder.
class Folder {
public:
  explicit Folder(const std::string& scene_path)
      : m_prefix(names_descriptor(scene_path) ? "./"
                                              : scene_path.substr(0, scene_path.rfind('/') + 1)) {}

  /// The file a key names; empty if the key is not there.
  std::string file(const SceneNode& node, std::string_view key) const {
    const auto name = node.find(key);
    if (!name)
      return {};
    const std::string text = name->text();
    const std::string path = text.front() == '/' ? text : m_prefix + text;
    return path == "-" ? "./-" : path; // a scene names files only
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
  for (const SceneNode& element : node.elements()) {
    const auto name = element.find("name");
    const std::string text = name ? name->text() : "";
    const auto same = std::find(names.begin(), names.end(), text);
    if (!text.empty() && same != names.end())
      name->fail("is the name of objects[" + std::to_string(same - names.begin()) + "] already");
    names.push_back(text);
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
    throw_input_error(path, "is larger than 64 MiB, which no scene is");
  const JsonValue value = parse_json(file.bytes(), path);
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
