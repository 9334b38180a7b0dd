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

/// A surface point as samplers see it; all directions in one frame.
struct ShadingPoint {
  Vec3 n;                     ///< unit normal, on the viewer's side
  Vec3 wo;                    ///< unit direction to the viewer, n·wo > 0
  ReflectionFrame reflection; ///< of n and wo
  const Hit* hit = nullptr;   ///< the point in the world, where anything may be in its light's way
};

ShadingPoint shading_point(const Vec3& n, const Vec3& wo);

class Reflectance {
public:
  virtual ~Reflectance() = default;

  /// f_r(ω_o, ω)·max(0, n·ω), sr⁻¹, for many directions at one point.
  virtual void evaluate(const ShadingPoint& point, std::span<const Vec3> directions,
                        std::span<Rgb> out) const = 0;

  /// The θ_r-only set of maps to make trees from; none if it is trees already.
  virtual std::unique_ptr<wavelet::MapSource> maps() const { return nullptr; }

  /// The set with rolls, for those that are cheap enough to make at load; else none.
  virtual std::unique_ptr<wavelet::MapSource> roll_maps() const { return nullptr; }

  /// The formula, for those that have a sampling routine of their own; else none.
  virtual const brdf::AnalyticBrdf* model() const { return nullptr; }
};

/// albedo/π.
std::unique_ptr<Reflectance> lambert_reflectance(const Rgb& albedo);

std::unique_ptr<Reflectance> measured_reflectance(brdf::MeasuredBrdf brdf);

std::unique_ptr<Reflectance> analytic_reflectance(const brdf::AnalyticBrdf& model);

/// What a θ_r-only set of trees says, blended between neighbouring cells.
std::unique_ptr<Reflectance> tree_reflectance(std::shared_ptr<const TreeTable> lobes);

/// Where a point's θ_r lies among the centres of a θ_r-only set's cells, in cells.
float theta_coordinate(const TreeTable& lobes, const ShadingPoint& point);

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
