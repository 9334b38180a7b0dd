#include <view/view_scene.h>

#include <renderer/scene/scene.h>
#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

namespace haarlight::view {

using namespace renderer;

namespace {

SceneDescription sphere_scene(const std::string& path) {
  SceneDescription scene;
  scene.path = path;
  scene.camera.from = Vec3(0, 0, 4.5F);
  scene.materials.emplace_back();
  scene.materials[0].name = "trees";
  scene.materials[0].haar = path;
  scene.objects.push_back({Sphere{}, {}, 0});
  return scene;
}

TreeTable stored_trees(const std::string& path) {
  TreeTable trees(path, wavelet::SetKind::Brdf);
  if (!trees.info().cosine || trees.info().rolls != 1)
    throw_input_error(path,
                      "holds a set with rolls or without the cosine; expected one that brdf2maps "
                      "makes by default");
  return trees;
}

/// Stored trees, else trees made from the material's data.
TreeTable trees_of(const MaterialDescription& material) {
  if (!material.haar.empty())
    return stored_trees(material.haar);
  if (material.model)
    return TreeTable(*analytic_reflectance(*material.model)->maps());
  if (!material.brdf.empty())
    return TreeTable(*measured_reflectance(brdf::MeasuredBrdf(material.brdf))->maps());
  return TreeTable(*lambert_reflectance(material.lambert.value_or(Rgb::Zero()))->maps());
}

} // namespace

SceneDescription describe_view(const std::string& path) {
  const bool trees = wavelet::begins_as_tree_set(InputFile(path));
  return trees ? sphere_scene(path) : load_scene(path);
}

LightDescription describe_light(const std::string& path) {
  LightDescription light;
  (wavelet::begins_as_tree_set(InputFile(path)) ? light.haar : light.probe) = path;
  return light;
}

Eigen::Matrix3f light_to_world(const Light& light) {
  Eigen::Matrix3f to_world;
  for (int axis = 0; axis < 3; ++axis)
    to_world.col(axis) = light.to_world(Vec3::Unit(axis));
  return to_world;
}

ViewScene::ViewScene(SceneDescription description) : m_description(std::move(description)) {
  for (const ObjectDescription& object : m_description.objects)
    m_shapes.add(object.shape, object.transform);
  check_shapes();
  for (const MaterialDescription& material : m_description.materials)
    add_material(material);
}

void ViewScene::check_shapes() const {
  for (const detail::Solid& solid : m_shapes.solids())
    if (solid.kind != detail::SolidKind::WorldSphere)
      throw_input_error(m_description.path, "objects[" + std::to_string(solid.object) +
                                                "] is neither a sphere nor a plane, the only "
                                                "shapes haarview shows");
}

void ViewScene::add_material(const MaterialDescription& description) {
  const auto lobes = std::make_shared<const TreeTable>(trees_of(description));
  const std::vector<wavelet::TreeView> trees = lobes->trees();
  m_columns.push_back(
      {static_cast<int>(m_trees.size()), static_cast<int>(trees.size()), trees.front().levels});
  m_trees.insert(m_trees.end(), trees.begin(), trees.end());
  m_reflectances.push_back(tree_reflectance(lobes));
}

} // namespace haarlight::view
