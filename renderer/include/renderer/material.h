#pragma once
// What a surface does to light: its true reflectance, and the trees that stand for it when
// sampling.

#include <renderer/scene.h>
#include <renderer/tree_table.h>

#include <brdf/measured_brdf.h>
#include <wavelet/adaptive_product.h>

#include <memory>
#include <optional>
#include <span>

namespace haarlight::renderer {

/// A surface point as samplers see it; all directions in one frame.
struct ShadingPoint {
  Vec3 n;                     ///< unit normal, on the viewer's side
  Vec3 wo;                    ///< unit direction to the viewer, n·wo > 0
  ReflectionFrame reflection; ///< of n and wo
};

ShadingPoint shading_point(const Vec3& n, const Vec3& wo);

/// One material of a scene, loaded. What is not given as a file is made: trees from the measured
/// table, or from the Lambertian; with trees alone, they are the truth.
class Material {
public:
  /// @throws Error(Input) as the files' readers do
  Material(const MaterialDescription& description, brdf::Lookup lookup);

  /// f_r(ω_o, ω)·max(0, n·ω), sr⁻¹, for many directions at one point.
  void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                std::span<Rgb> out) const;

  /// The same for one.
  Rgb evaluate(const ShadingPoint& point, const Vec3& direction) const;

  /// Makes what samplers use in place of the truth: the θ_r trees and their pyramid, if not there
  /// yet.
  void need_trees();

  /// The θ_r-only set seen from a point: for AdaptiveProduct. After need_trees().
  wavelet::RotatedReflectance reflectance(const ShadingPoint& point) const;

  /// The tree of the θ_r cell nearest to a point's, in its reflection frame. After need_trees().
  const wavelet::TreeView& lobe(const ShadingPoint& point) const;

  /// Makes the set with rolls for a Lambertian that has none; measured materials must name theirs.
  void need_roll_table();

  /// The set with rolls, if there is one.
  const TreeTable* roll_table() const { return m_rolls ? &*m_rolls : nullptr; }

  const std::string& name() const { return m_name; }
  std::size_t pyramid_bytes() const { return m_pyramid ? m_pyramid->bytes() : 0; }

private:
  float theta_coordinate(const ShadingPoint& point) const;
  Rgb from_trees(const ShadingPoint& point, const Vec3& direction) const;
  void evaluate_measured(const ShadingPoint& point, std::span<const Vec3> directions,
                         std::span<Rgb> out) const;
  void require_cosine(const std::string& path, const TreeTable& table) const;

  std::string m_name;
  std::optional<Rgb> m_lambert; ///< albedo
  std::optional<brdf::MeasuredBrdf> m_measured;
  std::optional<TreeTable> m_lobes; ///< θ_r only
  std::optional<TreeTable> m_rolls;
  std::optional<wavelet::Pyramid> m_pyramid;
};

} // namespace haarlight::renderer
