#include <view/view_scene.h>

#include <renderer/scene/scene.h>
#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

namespace haarlight::view {

using namespace renderer;

namespace {

SceneDescription sphere_of(const std::string& path) {
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
                      "holds a set with rolls or without the cosine; one that brdf2maps makes "
                      "by default is needed");
  return trees;
}

/// From the file that is named, else made.
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
  return trees ? sphere_of(path) : load_scene(path);
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
                                                "] is neither a sphere nor a plane; others cannot "
                                                "be viewed");
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
