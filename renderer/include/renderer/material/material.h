#pragma once
// One loaded material of a scene: its reflectance, and the trees that samplers use for it.

#include <renderer/material/tree_table.h>
#include <renderer/scene/scene.h>

#include <brdf/analytic.h>
#include <brdf/measured_brdf.h>
#include <wavelet/product/adaptive_product.h>

#include <memory>
#include <optional>
#include <span>

namespace haarlight::renderer {
struct Hit;

/// A surface point; all directions in the light's frame.
struct ShadingPoint {
  Vec3 n;                     ///< unit normal, on the viewer's side
  Vec3 wo;                    ///< unit direction to the viewer, n·wo > 0
  ReflectionFrame reflection; ///< of n and wo
  const Hit* hit = nullptr;   ///< the point in the world, if there are possible occluders
};

ShadingPoint shading_point(const Vec3& n, const Vec3& wo);

class Reflectance {
public:
  virtual ~Reflectance() = default;

  /// f_r(ω_o, ω)·max(0, n·ω), sr⁻¹, for many directions at one point.
  virtual void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                        std::span<Rgb> out) const = 0;

  /// The θ_r-only set of maps to build trees from; null if the reflectance is given by trees.
  virtual std::unique_ptr<wavelet::MapSource> maps() const { return nullptr; }

  /// The set with rolls, where it is cheap enough to build at load time; else null.
  virtual std::unique_ptr<wavelet::MapSource> roll_maps() const { return nullptr; }

  /// The analytic model with its own sampling routine; else null.
  virtual const brdf::AnalyticBrdf* model() const { return nullptr; }
};

/// albedo/π.
std::unique_ptr<Reflectance> lambert_reflectance(const Rgb& albedo);

std::unique_ptr<Reflectance> measured_reflectance(brdf::MeasuredBrdf brdf);

std::unique_ptr<Reflectance> analytic_reflectance(const brdf::AnalyticBrdf& model);

/// Values of a θ_r-only set of trees, interpolated between neighbouring cells.
std::unique_ptr<Reflectance> tree_reflectance(std::shared_ptr<const TreeTable> lobes);

/// A point's θ_r in cells of a θ_r-only set; integers are the centres of cells.
float theta_coordinate(const TreeTable& lobes, const ShadingPoint& point);

/// Trees that are not given as files are built from the measured table or from the analytic model.
/// If only trees are given, they define the reflectance.
class Material {
public:
  /// @throws Error(Input) as the files' readers do
  Material(const MaterialDescription& description, brdf::Lookup lookup);

  /// f_r(ω_o, ω)·max(0, n·ω), sr⁻¹, for many directions at one point.
  void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                std::span<Rgb> out) const {
    m_source_reflectance->evaluate(point, directions, out);
  }

  /// The same for one direction.
  Rgb evaluate(const ShadingPoint& point, const Vec3& direction) const;

  /// The analytic model with its own sampling routine; null for other materials.
  const brdf::AnalyticBrdf* model() const { return m_source_reflectance->model(); }

  /// Builds the θ_r-only trees and their pyramid, if missing.
  void require_trees();

  /// Builds the trees unless the reflectance has its own sampling routine.
  void require_lobe();

  /// The θ_r-only set rotated to a point, for AdaptiveProduct. Requires require_trees().
  wavelet::RotatedReflectance reflectance(const ShadingPoint& point) const;

  /// The tree of the nearest θ_r cell, in the point's reflection frame. Requires require_trees().
  const wavelet::TreeView& lobe(const ShadingPoint& point) const;

  /// Builds the set with rolls of an analytic model; measured materials must name theirs.
  void require_roll_table();

  /// The set with rolls, if there is one.
  const TreeTable* roll_table() const { return m_rolls ? &*m_rolls : nullptr; }

  /// Emitted radiance, the same in all directions.
  const Rgb& emission() const { return m_emission; }

  const std::string& name() const { return m_name; }
  bool has_trees() const { return m_pyramid.has_value(); }

private:
  std::string m_name;
  Rgb m_emission = Rgb::Zero();
  std::shared_ptr<const TreeTable> m_lobes; ///< θ_r only
  std::optional<TreeTable> m_rolls;
  std::unique_ptr<Reflectance> m_source_reflectance;
  std::optional<wavelet::Pyramid> m_pyramid;
};

} // namespace haarlight::renderer
