#include <renderer/scene/loaded_scene.h>

#include <wavelet/base/error.h>

#include <ctime>

namespace haarlight::renderer {

LoadedScene::LoadedScene(const SceneDescription& description, const SourceLookups& lookups,
                         SamplerKind sampler, bool unshadowed_product, unsigned further)
    : m_description(description), m_light(description.light, lookups.probe) {
  for (const ObjectDescription& object : description.objects)
    m_shapes.add(object.shape, object.transform);
  m_materials.reserve(description.materials.size());
  for (const MaterialDescription& material : description.materials)
    m_materials.emplace_back(material, lookups.brdf);
  const unsigned needed = traits(sampler).needs | further;
  const std::clock_t start = std::clock();
  if ((needed & NeedsLightDistribution) != 0)
    m_light.require_distribution();
  if ((needed & NeedsLightTree) != 0 || unshadowed_product)
    m_light.require_tree();
  if ((needed & NeedsMaterialTrees) != 0 || unshadowed_product)
    for (Material& material : m_materials)
      material.require_trees();
  if ((needed & NeedsLobes) != 0)
    for (Material& material : m_materials)
      material.require_lobe();
  if ((needed & NeedsTables) != 0) {
    for (Material& material : m_materials)
      material.require_roll_table();
    check_tables(traits(sampler).name);
  }
  m_preparation_seconds =
      static_cast<double>(std::clock() - start) / static_cast<double>(CLOCKS_PER_SEC);
}

void LoadedScene::check_tables(const std::string& sampler) const {
  const TreeTable* light = m_light.rotated_table();
  if (light == nullptr)
    throw_input_error(m_description.path, "light: the key \"table\" is missing; the sampler " +
                                              sampler +
                                              " needs a .haar of probe2maps --orientations M");
  for (std::size_t i = 0; i < m_materials.size(); ++i) {
    const TreeTable* rolls = m_materials[i].roll_table();
    if (rolls == nullptr)
      throw_input_error(m_description.path,
                        std::string("materials.")
                            .append(m_materials[i].name())
                            .append(": the key \"table\" is missing; the sampler ")
                            .append(sampler)
                            .append(" needs a .haar of brdf2maps --roll N"));
  }
}

} // namespace haarlight::renderer
