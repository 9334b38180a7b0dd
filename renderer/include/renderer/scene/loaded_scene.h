#pragma once
// A scene with everything its description names, ready to render.

#include <renderer/light/light.h>
#include <renderer/material/material.h>
#include <renderer/samplers/sampler_kind.h>
#include <renderer/scene/camera.h>
#include <renderer/scene/scene.h>
#include <renderer/shapes/shapes.h>

#include <string>
#include <vector>

namespace haarlight::renderer {

/// How the sources are looked up where they are the truth.
struct SourceLookups {
  brdf::Lookup brdf = brdf::Lookup::Trilinear;
  probe::Lookup probe = probe::Lookup::Nearest;
};

/// Owns shapes, materials and light. Not copied: products point into it.
class LoadedScene {
public:
  /// Opens the files a description names and makes what `sampler` and `unshadowed_product` need.
  /// @param unshadowed_product whether the estimator needs L_ns of a product whatever the sampler
  /// @param further what the integrator needs besides, of SamplerNeed
  /// @throws Error(Input) if a file is broken, of the wrong kind, or one that the sampler needs is
  /// not named
  LoadedScene(const SceneDescription& description, const SourceLookups& lookups,
              SamplerKind sampler, bool unshadowed_product, unsigned further = NeedsNothing);
  LoadedScene(const LoadedScene&) = delete;
  LoadedScene& operator=(const LoadedScene&) = delete;

  const SceneDescription& description() const { return m_description; }
  const ShapeSet& shapes() const { return m_shapes; }
  const Light& light() const { return m_light; }
  const Material& material_of(int object) const {
    return m_materials[static_cast<std::size_t>(
        m_description.objects[static_cast<std::size_t>(object)].material)];
  }
  const std::vector<Material>& materials() const { return m_materials; }

  /// CPU time that making what the sampler needs took, reading files apart.
  double preparation_seconds() const { return m_preparation_seconds; }

private:
  void check_tables(const std::string& sampler) const;

  SceneDescription m_description;
  ShapeSet m_shapes;
  Light m_light;
  std::vector<Material> m_materials;
  double m_preparation_seconds = 0;
};

} // namespace haarlight::renderer
