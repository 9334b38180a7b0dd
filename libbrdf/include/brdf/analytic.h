#pragma once
// Isotropic analytic reflectance models with the parameters of their papers, and their importance
// sampling.
//
// Every model gives f_r in sr⁻¹, without cosine, for unit vectors in the local frame (z = normal),
// and 0 where wi or wo is not above the horizon. Colours are linear RGB. `diffuse` adds a
// Lambertian part, diffuse/π; nothing scales it down, so diffuse + specular should stay below one.

#include <wavelet/base/geometry.h>

#include <variant>

namespace haarlight::brdf {

/// The parameters of isotropic models, in double. Cosines are of the angles from the normal; sin_h
/// and cos_h of θ_h; cos_d = cos θ_d between half vector and either direction.
struct Angles {
  double cos_i = 1;
  double cos_o = 1;
  double sin_h = 0;
  double cos_h = 1;
  double cos_d = 1;
};

Angles angles_of(const Vec3& local_wi, const Vec3& local_wo);

/// Walter et al. 2007: D·G·F / (4 cos θ_i cos θ_o), G separable, F by Schlick 1994.
struct Ggx {
  Rgb diffuse = Rgb::Zero();
  Rgb specular = Rgb::Constant(0.04F); ///< F0, reflectance at normal incidence, in [0, 1]
  double roughness = 0.2;              ///< width α_g, in (0, 1]
  Rgb evaluate(const Angles& angles) const;
};

/// Blinn 1977, normalised so that `specular` is the albedo at normal incidence: cos^n θ_h times
/// (n + 2)(n + 4) / (8π (2^(−n/2) + n)).
struct BlinnPhong {
  Rgb diffuse = Rgb::Zero();
  Rgb specular = Rgb::Constant(0.5F);
  double exponent = 100; ///< n > 0
  Rgb evaluate(const Angles& angles) const;
};

/// Ward 1992, isotropic: exp(−tan²θ_h / α²) / (4π α² sqrt(cos θ_i cos θ_o)).
struct Ward {
  Rgb diffuse = Rgb::Zero();
  Rgb specular = Rgb::Constant(0.5F); ///< ρ_s, about the albedo at normal incidence
  double roughness = 0.2;             ///< α, the slope's standard deviation times √2
  Rgb evaluate(const Angles& angles) const;
};

/// Lafortune et al. 1997, one isotropic lobe: max(0, C_xy (x_i x_o + y_i y_o) + C_z z_i z_o)^n
/// times (n + 2) / (2π max(|C_xy|, |C_z|)^n), so that `specular` is the albedo at normal incidence
/// of the plain mirror lobe C_xy = −C_z.
struct Lafortune {
  Rgb diffuse = Rgb::Zero();
  Rgb specular = Rgb::Constant(0.5F);
  double exponent = 40; ///< n > 0
  double c_xy = -1; ///< −C_z: mirror lobe; larger |C_xy|: off-specular; positive: retro-reflecting
  double c_z = 1;
  Rgb evaluate(const Angles& angles) const;
};

/// Ashikhmin & Shirley 2000 with n_u = n_v = n; their own diffuse part, coupled to the specular
/// one.
struct AshikhminShirley {
  Rgb diffuse = Rgb::Zero();           ///< R_d
  Rgb specular = Rgb::Constant(0.05F); ///< R_s, reflectance at normal incidence
  double exponent = 100;               ///< n ≥ 0
  Rgb evaluate(const Angles& angles) const;
};

using AnalyticBrdf = std::variant<Ggx, BlinnPhong, Ward, Lafortune, AshikhminShirley>;

Rgb evaluate(const AnalyticBrdf& model, const Angles& angles);

/// f_r of two directions in the local frame, sr⁻¹.
Rgb evaluate(const AnalyticBrdf& model, const Vec3& local_wi, const Vec3& local_wo);

// Importance sampling of a model, by the routine published for it. A sample follows the diffuse
// part (cosine-weighted) or the specular one, chosen with a fixed probability; the density is that
// of the mixture. Specular parts:
//   Ggx                half vectors from the visible normals (Heitz 2018)
//   BlinnPhong         half vectors by (n + 1) / 2π cos^n θ_h (Pharr and Humphreys 2004, 15.5.1)
//   Ward               half vectors by exp(−tan²θ_h / α²) / (π α² cos³θ_h) (Walter 2005, eqs. 6, 9)
//   Lafortune          (n + 1) / 2π cos^n about (C_xy x_o, C_xy y_o, C_z z_o) (Lafortune et al.
//                      1997)
//   AshikhminShirley   half vectors by (n + 1) / 2π cos^n θ_h (Ashikhmin and Shirley 2000, eqs. 6,
//                      8, 9)
// A half vector h has dω_h = dω_i / (4 |ω_o·h|).

/// Samples a model for one outgoing direction. Keeps a pointer to the model.
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
  float m_diffuse_probability = 1; ///< that a sample is cosine-weighted
};

} // namespace haarlight::brdf
