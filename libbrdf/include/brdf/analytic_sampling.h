#pragma once
// Importance sampling of the analytic models, each by the routine published for it.
//
// Local frame as in <brdf/analytic.h>: z = the normal. A sample follows the diffuse part, by the
// cosine, or the specular one; which of them is chosen with a fixed share, and the density is that
// of both together. Specular parts:
//   Ggx                half vectors from the visible normals (Heitz 2018)
//   BlinnPhong         half vectors by (n + 1) / 2π cos^n θ_h (Pharr and Humphreys 2004, 15.5.1)
//   Ward               half vectors by exp(−tan²θ_h / α²) / (π α² cos³θ_h) (Walter 2005, eqs. 6, 9)
//   Lafortune          (n + 1) / 2π cos^n about (C_xy x_o, C_xy y_o, C_z z_o) (Lafortune et al.
//                      1997)
//   AshikhminShirley   half vectors by (n + 1) / 2π cos^n θ_h (Ashikhmin and Shirley 2000, eqs. 6,
//                      8, 9)
// A half vector h has dω_h = dω_i / (4 |ω_o·h|).

#include <brdf/analytic.h>

namespace haarlight::brdf {

/// A model seen from one direction. Keeps a pointer to the model.
class AnalyticSampling {
public:
  AnalyticSampling() = default;

  /// @param local_wo unit, above the horizon but for rounding
  AnalyticSampling(const AnalyticBrdf& model, const Vec3& local_wo);

  /// The direction ω_i, a unit vector, for a point of [0, 1)². It may lie below the horizon, where
  /// nothing is reflected.
  Vec3 sample(const Vec2& u) const;

  /// Density of sample() at a unit direction, sr⁻¹. Its integral over the whole sphere is one, and
  /// it is positive wherever f_r is.
  float pdf(const Vec3& local_wi) const;

private:
  const AnalyticBrdf* m_model = nullptr;
  Vec3 m_wo = Vec3::UnitZ();
  float m_diffuse_share = 1; ///< probability that a sample follows the cosine
};

} // namespace haarlight::brdf
