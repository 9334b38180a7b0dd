#include <renderer/loaded_scene.h>

#include <wavelet/error.h>

namespace haarlight::renderer {

LoadedScene::LoadedScene(const SceneDescription& description, const SourceLookups& lookups,
                         SamplerKind sampler, bool unshadowed_product)
    : m_description(description), m_light(description.light, lookups.probe) {
  for (const ObjectDescription& object : description.objects)
    m_shapes.add(object.shape, object.transform);
  m_materials.reserve(description.materials.size());
  for (const MaterialDescription& material : description.materials)
    m_materials.emplace_back(material, lookups.brdf);
  if (needs_light_distribution(sampler))
    m_light.need_distribution();
  const bool product = sampler == SamplerKind::Product || unshadowed_product;
  if (needs_light_tree(sampler) || product)
    m_light.need_tree();
  if (needs_material_trees(sampler) || product)
    for (Material& material : m_materials)
      material.need_trees();
  if (sampler == SamplerKind::ProductTable) {
    for (Material& material : m_materials)
      material.need_roll_table();
    check_tables();
  }
}

void LoadedScene::check_tables() const {
  const TreeTable* light = m_light.rotated_table();
  if (light == nullptr)
    throw_input_error(m_description.path,
                      "light: names no \"table\", which product-table needs: a .haar "
                      "made by probe2maps --orientations M");
  for (std::size_t i = 0; i < m_materials.size(); ++i) {
    const TreeTable* rolls = m_materials[i].roll_table();
    const std::string where = "materials." + m_materials[i].name();
    if (rolls == nullptr)
      throw_input_error(m_description.path,
                        where + ": names no \"table\", which product-table needs: a "
                                ".haar made by brdf2maps --roll N");
  }
}

} // namespace haarlight::renderer
