#pragma once
// What a viewer shows: spheres and planes, their trees and one lamp. No GL here.

#include <renderer/material/material.h>
#include <renderer/scene/camera.h>
#include <renderer/scene/scene.h>
#include <renderer/shapes/shapes.h>

#include <algorithm>
#include <string>
#include <vector>

namespace haarlight::view {

/// One light, from infinitely far or from a point.
struct Lamp {
  bool at_point = false;
  Vec3 place = Vec3(0.4F, 0.6F, 0.7F); ///< direction towards it (any length but zero), or position
  Rgb irradiance = Rgb::Ones(); ///< of a surface facing it, W m⁻²; of a point's, at distance 1
};

/// The columns of one material's trees among those of all.
struct Columns {
  int first = 0;
  int count = 0;
  int levels = 0;
};

/// @param path a scene file, or a θ_r-only BRDF set, which becomes a unit sphere
/// @throws Error(Input) if it is neither
renderer::SceneDescription describe_view(const std::string& path);

/// A scene's shapes and trees, ready to be shown; its light, background and emission are not.
class ViewScene {
public:
  /// @throws Error(Input) if a file is broken or of the wrong kind, or a shape is neither sphere
  ///         nor plane
  explicit ViewScene(const std::string& path) : ViewScene(describe_view(path)) {}
  explicit ViewScene(renderer::SceneDescription description);

  const renderer::SceneDescription& description() const { return m_description; }
  const renderer::ShapeSet& shapes() const { return m_shapes; }

  /// Of all materials, one after the other.
  const std::vector<wavelet::TreeView>& trees() const { return m_trees; }
  /// Of each material, among them.
  const std::vector<Columns>& columns() const { return m_columns; }
  /// Of the material of an object.
  const Columns& columns_of(int object) const { return m_columns[material_of(object)]; }
  /// Of the deepest tree.
  int levels() const {
    const auto deeper = [](const auto& a, const auto& b) { return a.levels < b.levels; };
    return std::max_element(m_columns.begin(), m_columns.end(), deeper)->levels;
  }
  /// What these trees say of an object, all levels deep.
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
