#pragma once
// A scene with its files loaded, ready to render.

#include <renderer/light/light.h>
#include <renderer/material/material.h>
#include <renderer/samplers/sampler_kind.h>
#include <renderer/scene/camera.h>
#include <renderer/scene/scene.h>
#include <renderer/shapes/shapes.h>

#include <string>
#include <vector>

namespace haarlight::renderer {

/// Interpolation of measured reflectances and of the probe.
struct SourceLookups {
  brdf::Lookup brdf = brdf::Lookup::Trilinear;
  probe::Lookup probe = probe::Lookup::Nearest;
};

/// Owns shapes, materials and light. Not copyable: products point into it.
class LoadedScene {
public:
  /// Opens the files of a description and computes the data that `sampler` needs.
  /// @param unshadowed_product whether the estimator needs L_ns of a product for any sampler
  /// @param further data that the integrator needs in addition, of SamplerNeed
  /// @throws Error(Input) if a file is malformed or of the wrong kind, or if a file that the
  /// sampler needs is not named
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

  /// CPU seconds spent on the sampler's data, without reading files.
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
