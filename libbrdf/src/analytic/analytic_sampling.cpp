#include <brdf/analytic_sampling.h>

#include "analytic/analytic_terms.h"

#include <wavelet/base/sampling.h>

#include <algorithm>
#include <cmath>

namespace haarlight::brdf {
namespace {

/// Either part gets this share of the samples at least, if the model has both.
constexpr float smallest_share = 0.1F;

/// By (n + 1) / 2π cos^n θ about z.
Vec3 cosine_power_direction(double n, const Vec2& u) {
  const double cosine = exponential(logarithm(1 - static_cast<double>(u.x())) / (n + 1));
  const SineCosine phi = sine_cosine(2 * std::numbers::pi * static_cast<double>(u.y()));
  const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  return Vec3(static_cast<float>(sine * phi.cosine), static_cast<float>(sine * phi.sine),
              static_cast<float>(cosine))
      .normalized();
}

/// Angles of a pair whose second is above the horizon, with the half vector turned upwards: every
/// direction of the sphere has exactly one such half vector.
Angles upward_angles(const Vec3& wi, const Vec3& wo) {
  Angles a = angles_of(wi, wo);
  a.cos_h = std::abs(a.cos_h);
  return a;
}

/// Density of the direction whose half vector has the density given.
double mirrored(double half_vector_density, const Angles& a) {
  return half_vector_density / (4 * std::max(a.cos_d, 1e-12));
}

double cosine_power_density(double n, const Angles& a) {
  return mirrored((n + 1) / (2 * std::numbers::pi) * cosine_power(a, n), a);
}

Vec3 sample_specular(const BlinnPhong& model, const Vec3& wo, const Vec2& u) {
  return mirror(wo, cosine_power_direction(model.exponent, u));
}

double specular_density(const BlinnPhong& model, const Vec3& wo, const Vec3& wi) {
  return cosine_power_density(model.exponent, upward_angles(wi, wo));
}

Vec3 sample_specular(const AshikhminShirley& model, const Vec3& wo, const Vec2& u) {
  return mirror(wo, cosine_power_direction(model.exponent, u));
}

double specular_density(const AshikhminShirley& model, const Vec3& wo, const Vec3& wi) {
  return cosine_power_density(model.exponent, upward_angles(wi, wo));
}

Vec3 sample_specular(const Ward& model, const Vec3& wo, const Vec2& u) {
  const double tan2 =
      -model.roughness * model.roughness * logarithm(1 - static_cast<double>(u.x()));
  const SineCosine phi = sine_cosine(2 * std::numbers::pi * static_cast<double>(u.y()));
  const double tangent = std::sqrt(std::max(0.0, tan2));
  const Vec3 slope(static_cast<float>(tangent * phi.cosine), static_cast<float>(tangent * phi.sine),
                   1.0F);
  return mirror(wo, slope.normalized());
}

double specular_density(const Ward& model, const Vec3& wo, const Vec3& wi) {
  const Angles a = upward_angles(wi, wo);
  const double alpha2 = model.roughness * model.roughness;
  const double cos2 = std::max(a.cos_h * a.cos_h, 1e-12);
  const double peak = std::numbers::pi * alpha2 * cos2 * std::sqrt(cos2);
  return mirrored(exponential(-a.sin_h * a.sin_h / (cos2 * alpha2)) / peak, a);
}

/// Axis of the lobe, not normalised; zero if nothing is reflected.
Vec3 lobe_axis(const Lafortune& model, const Vec3& wo) {
  const auto c_xy = static_cast<float>(model.c_xy);
  return {c_xy * wo.x(), c_xy * wo.y(), static_cast<float>(model.c_z) * wo.z()};
}

Vec3 sample_specular(const Lafortune& model, const Vec3& wo, const Vec2& u) {
  const Frame about = frame_about(lobe_axis(model, wo).normalized());
  return about.to_outer(cosine_power_direction(model.exponent, u)).normalized();
}

double specular_density(const Lafortune& model, const Vec3& wo, const Vec3& wi) {
  const Eigen::Vector3d axis = lobe_axis(model, wo).cast<double>().normalized();
  const double cosine = std::clamp(axis.dot(wi.cast<double>().normalized()), 0.0, 1.0);
  return (model.exponent + 1) / (2 * std::numbers::pi) * power(cosine, model.exponent);
}

/// Listing 1 of Heitz 2018, isotropic.
Vec3 sample_specular(const Ggx& model, const Vec3& wo, const Vec2& u) {
  const auto alpha = static_cast<float>(model.roughness);
  const Frame view = frame_about(Vec3(alpha * wo.x(), alpha * wo.y(), wo.z()).normalized());
  // The projection's second axis lies in the plane of the view and the normal.
  const Vec3 across(-view.n.y(), view.n.x(), 0);
  const float length = across.norm();
  const Vec3 t1 = length > 1e-7F ? Vec3(across / length) : view.t;
  const Vec3 t2 = view.n.cross(t1);
  const SineCosine phi = sine_cosine(2 * std::numbers::pi * static_cast<double>(u.y()));
  const float r = std::sqrt(u.x());
  const float x = r * static_cast<float>(phi.cosine);
  const float s = 0.5F * (1 + view.n.z());
  const float y =
      (1 - s) * std::sqrt(std::max(0.0F, 1 - x * x)) + s * r * static_cast<float>(phi.sine);
  const Vec3 h = x * t1 + y * t2 + std::sqrt(std::max(0.0F, 1 - x * x - y * y)) * view.n;
  return mirror(wo, Vec3(alpha * h.x(), alpha * h.y(), std::max(1e-9F, h.z())).normalized());
}

/// Half vectors that are drawn look towards ω_o, so that only those above the horizon count.
double specular_density(const Ggx& model, const Vec3& wo, const Vec3& wi) {
  const Angles a = angles_of(wi, wo);
  if (a.cos_h <= 0)
    return 0;
  const double alpha2 = model.roughness * model.roughness;
  return 0.25 * ggx_distribution(a, alpha2) * ggx_masking_over_cosine(a.cos_o, alpha2);
}

/// About what share of light the specular part reflects.
template <class M>
Rgb specular_albedo(const M& model, const Vec3& /*wo*/) {
  return model.specular;
}
Rgb specular_albedo(const Ggx& model, const Vec3& wo) {
  return fresnel(model.specular, static_cast<double>(wo.z()));
}
Rgb specular_albedo(const AshikhminShirley& model, const Vec3& wo) {
  return fresnel(model.specular, static_cast<double>(wo.z()));
}
Rgb specular_albedo(const Lafortune& model, const Vec3& wo) {
  return lobe_axis(model, wo).isZero(0) ? Rgb(Rgb::Zero()) : model.specular;
}

template <class M>
float diffuse_share(const M& model, const Vec3& wo) {
  const float diffuse = luminance(model.diffuse);
  const float specular = luminance(specular_albedo(model, wo));
  if (specular <= 0)
    return 1;
  if (diffuse <= 0)
    return 0;
  return std::clamp(diffuse / (diffuse + specular), smallest_share, 1 - smallest_share);
}

} // namespace

AnalyticSampling::AnalyticSampling(const AnalyticBrdf& model, const Vec3& local_wo)
    : m_model(&model), m_wo(local_wo),
      m_diffuse_share(
          std::visit([&](const auto& m) { return diffuse_share(m, local_wo); }, model)) {}

Vec3 AnalyticSampling::sample(const Vec2& u) const {
  if (u.x() < m_diffuse_share)
    return sample_cosine_hemisphere({u.x() / m_diffuse_share, u.y()});
  // Rounding may not bring the point to the square's edge.
  const float rest = std::min((u.x() - m_diffuse_share) / (1 - m_diffuse_share), 0x1.fffffep-1F);
  return std::visit([&](const auto& m) { return sample_specular(m, m_wo, Vec2(rest, u.y())); },
                    *m_model);
}

float AnalyticSampling::pdf(const Vec3& local_wi) const {
  const auto diffuse = static_cast<double>(m_diffuse_share);
  double density = diffuse * static_cast<double>(cosine_hemisphere_pdf(local_wi));
  if (m_diffuse_share < 1)
    density +=
        (1 - diffuse) *
        std::visit([&](const auto& m) { return specular_density(m, m_wo, local_wi); }, *m_model);
  return static_cast<float>(density);
}

} // namespace haarlight::brdf
