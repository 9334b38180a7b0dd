#pragma once
// One material of a scene, loaded: its true reflectance, and the trees that stand for it when
// sampling.

#include <renderer/material/reflectance.h>
#include <renderer/material/tree_table.h>
#include <renderer/scene/scene.h>

#include <wavelet/product/adaptive_product.h>

#include <memory>
#include <optional>
#include <span>

namespace haarlight::renderer {

/// What is not given as a file is made: trees from the measured table, or from the formula; with
/// trees alone, they are the truth.
class Material {
public:
  /// @throws Error(Input) as the files' readers do
  Material(const MaterialDescription& description, brdf::Lookup lookup);

  /// f_r(ω_o, ω)·max(0, n·ω), sr⁻¹, for many directions at one point.
  void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                std::span<Rgb> out) const {
    m_source_reflectance->evaluate(point, directions, out);
  }

  /// The same for one.
  Rgb evaluate(const ShadingPoint& point, const Vec3& direction) const;

  /// The formula, if the material is one with a sampling routine of its own.
  const brdf::AnalyticBrdf* model() const { return m_source_reflectance->model(); }

  /// Makes what samplers use in place of the truth: the θ_r trees and their pyramid, if not there
  /// yet.
  void require_trees();

  /// Makes what sampling the reflectance alone uses: the trees, unless it has a routine of its own.
  void require_lobe();

  /// The θ_r-only set seen from a point: for AdaptiveProduct. After require_trees().
  wavelet::RotatedReflectance reflectance(const ShadingPoint& point) const;

  /// The tree of the θ_r cell nearest to a point's, in its reflection frame. After require_trees().
  const wavelet::TreeView& lobe(const ShadingPoint& point) const;

  /// Makes the set with rolls for a formula that has none; measured materials must name theirs.
  void require_roll_table();

  /// The set with rolls, if there is one.
  const TreeTable* roll_table() const { return m_rolls ? &*m_rolls : nullptr; }

  /// Radiance that it sends into all directions by itself.
  const Rgb& emission() const { return m_emission; }

  const std::string& name() const { return m_name; }
  std::size_t pyramid_bytes() const { return m_pyramid ? m_pyramid->bytes() : 0; }

private:
  std::string m_name;
  Rgb m_emission = Rgb::Zero();
  std::shared_ptr<const TreeTable> m_lobes; ///< θ_r only
  std::optional<TreeTable> m_rolls;
  std::unique_ptr<Reflectance> m_source_reflectance;
  std::optional<wavelet::Pyramid> m_pyramid;
};

} // namespace haarlight::renderer
