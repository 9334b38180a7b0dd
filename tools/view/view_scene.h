#pragma once
// The scenes that the viewer shows: spheres and planes with stored trees. Nothing here calls GL.

#include <renderer/light/light.h>
#include <renderer/material/material.h>
#include <renderer/scene/camera.h>
#include <renderer/scene/scene.h>
#include <renderer/shapes/shapes.h>

#include <algorithm>
#include <string>
#include <vector>

namespace haarlight::view {

/// A directional or a point light.
struct PunctualLight {
  bool is_point = false;
  Vec3 place = Vec3(0.4F, 0.6F, 0.7F); ///< position, or direction towards the light (any length
                                       ///< but zero)
  Vec3 irradiance = Vec3::Ones(); ///< R, G, B of a surface that faces the light, W m⁻²; for a point
                                  ///< light at distance 1

  bool operator==(const PunctualLight&) const = default;
};

/// The range of one material's trees among those of all materials.
struct Columns {
  int first = 0;
  int count = 0;
  int levels = 0;
};

/// @param path a scene file, or a θ_r-only BRDF set, which becomes a unit sphere
/// @throws Error(Input) if it is neither
renderer::SceneDescription describe_view(const std::string& path);

/// An image or the trees of a light as a scene would name it. @throws Error(Input) if it is missing
renderer::LightDescription describe_light(const std::string& path);

/// The rotation from a light's frame to the world.
Eigen::Matrix3f light_to_world(const renderer::Light& light);

/// A scene's shapes and trees; its light, background and emission are ignored.
class ViewScene {
public:
  /// @throws Error(Input) if a file is broken or of the wrong kind, or a shape is neither sphere
  ///         nor plane
  explicit ViewScene(const std::string& path) : ViewScene(describe_view(path)) {}
  explicit ViewScene(renderer::SceneDescription description);

  const renderer::SceneDescription& description() const { return m_description; }
  const renderer::ShapeSet& shapes() const { return m_shapes; }

  /// Trees of all materials, in their order.
  const std::vector<wavelet::TreeView>& trees() const { return m_trees; }
  /// The range of each material in trees().
  const std::vector<Columns>& columns() const { return m_columns; }
  /// The range of an object's material.
  const Columns& columns_of(int object) const { return m_columns[material_of(object)]; }
  /// Levels of the deepest tree.
  int levels() const {
    const auto deeper = [](const auto& a, const auto& b) { return a.levels < b.levels; };
    return std::max_element(m_columns.begin(), m_columns.end(), deeper)->levels;
  }
  /// The reflectance of an object that its trees store, at full resolution.
  const renderer::Reflectance& reflectance_of(int object) const {
    return *m_reflectances[material_of(object)];
  }

private:
  std::size_t material_of(int object) const {
    const auto& objects = m_description.objects;
    return static_cast<std::size_t>(objects[static_cast<std::size_t>(object)].material);
  }
  void add_material(const renderer::MaterialDescription& description);
  void check_shapes() const;

  renderer::SceneDescription m_description;
  renderer::ShapeSet m_shapes;
  std::vector<wavelet::TreeView> m_trees;
  std::vector<Columns> m_columns;
  std::vector<std::unique_ptr<renderer::Reflectance>> m_reflectances;
};

} // namespace haarlight::view
