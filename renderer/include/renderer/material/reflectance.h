#pragma once
// What is true of a material: its reflectance by formula, measurement or trees, one class each.

#include <renderer/material/lambert_maps.h>
#include <renderer/material/tree_table.h>

#include <brdf/analytic.h>
#include <brdf/measured_brdf.h>
#include <wavelet/product/adaptive_product.h>

#include <memory>
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

} // namespace haarlight::renderer
