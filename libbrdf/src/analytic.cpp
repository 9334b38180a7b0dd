#include <brdf/analytic.h>

#include <wavelet/base/elementary.h>
#include <wavelet/base/sampling.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace haarlight::brdf {
namespace {

// Terms that values and sampling have in common.

double fifth_power(double x) { return x * x * x * x * x; }

/// Schlick 1994.
Rgb fresnel(const Rgb& at_normal, double cosine) {
  const auto rise = static_cast<float>(fifth_power(1 - cosine));
  return at_normal + (1.0F - at_normal) * rise;
}

/// cos^n θ_h without losing the difference from one of a cosine next to it.
double cosine_power(const Angles& a, double n) {
  return a.cos_h > 0.7 ? exponential(0.5 * n * logarithm(1 - a.sin_h * a.sin_h))
                       : power(a.cos_h, n);
}

/// GGX's distribution of normals D, Walter et al. 2007, eq. 33.
double ggx_distribution(const Angles& a, double alpha2) {
  const double spread = a.sin_h * a.sin_h + alpha2 * a.cos_h * a.cos_h;
  return alpha2 / (std::numbers::pi * spread * spread);
}

/// 2 / (1 + sqrt(1 + α² tan²θ)), Walter's eq. 34, divided by cos θ.
double ggx_masking_over_cosine(double cosine, double alpha2) {
  return 2 / (cosine + std::sqrt(cosine * cosine + alpha2 * (1 - cosine * cosine)));
}

Rgb lambert_plus(const Rgb& diffuse, const Rgb& specular, double lobe) {
  return diffuse * static_cast<float>(1 / std::numbers::pi) + specular * static_cast<float>(lobe);
}

} // namespace

Angles angles_of(const Vec3& local_wi, const Vec3& local_wo) {
  const Eigen::Vector3d wi = local_wi.cast<double>().normalized();
  const Eigen::Vector3d wo = local_wo.cast<double>().normalized();
  const Eigen::Vector3d h = wi + wo;
  const double length = std::max(h.norm(), 1e-300);
  return {wi.z(), wo.z(), std::sqrt(h.x() * h.x() + h.y() * h.y()) / length, h.z() / length,
          0.5 * length};
}

Rgb Ggx::evaluate(const Angles& a) const {
  const double alpha2 = roughness * roughness;
  const double lobe = 0.25 * ggx_distribution(a, alpha2) *
                      ggx_masking_over_cosine(a.cos_i, alpha2) *
                      ggx_masking_over_cosine(a.cos_o, alpha2);
  return lambert_plus(diffuse, fresnel(specular, a.cos_d), lobe);
}

Rgb BlinnPhong::evaluate(const Angles& a) const {
  const double n = exponent;
  const double norm =
      (n + 2) * (n + 4) / (8 * std::numbers::pi * (exponential(-0.5 * n * std::numbers::ln2) + n));
  return lambert_plus(diffuse, specular, norm * cosine_power(a, n));
}

Rgb Ward::evaluate(const Angles& a) const {
  const double alpha2 = roughness * roughness;
  const double tan2 = a.sin_h * a.sin_h / std::max(a.cos_h * a.cos_h, 1e-12);
  const double lobe =
      exponential(-tan2 / alpha2) / (4 * std::numbers::pi * alpha2 * std::sqrt(a.cos_i * a.cos_o));
  return lambert_plus(diffuse, specular, lobe);
}

Rgb Lafortune::evaluate(const Angles& a) const {
  // ω_i·ω_o = cos 2θ_d; the tangential part is the rest after the product of the z components.
  const double z_product = a.cos_i * a.cos_o;
  const double tangential = 2 * a.cos_d * a.cos_d - 1 - z_product;
  const double largest = std::max(std::abs(c_xy), std::abs(c_z));
  const double base = std::max(0.0, (c_xy * tangential + c_z * z_product) / largest);
  return lambert_plus(diffuse, specular,
                      (exponent + 2) / (2 * std::numbers::pi) * power(base, exponent));
}

Rgb AshikhminShirley::evaluate(const Angles& a) const {
  const double lobe = (exponent + 1) / (8 * std::numbers::pi) * cosine_power(a, exponent) /
                      (std::max(a.cos_d, 1e-6) * std::max(a.cos_i, a.cos_o));
  const double both = (1 - fifth_power(1 - 0.5 * a.cos_i)) * (1 - fifth_power(1 - 0.5 * a.cos_o));
  const Rgb matt =
      diffuse * (1.0F - specular) * static_cast<float>(28 / (23 * std::numbers::pi) * both);
  return matt + fresnel(specular, a.cos_d) * static_cast<float>(lobe);
}

Rgb evaluate(const AnalyticBrdf& model, const Angles& angles) {
  return std::visit([&](const auto& m) -> Rgb { return m.evaluate(angles); }, model);
}

Rgb evaluate(const AnalyticBrdf& model, const Vec3& local_wi, const Vec3& local_wo) {
  if (!(local_wi.z() > 0 && local_wo.z() > 0))
    return Rgb::Zero();
  return evaluate(model, angles_of(local_wi, local_wo));
}

namespace {

/// Least probability of either part, if the model has both.
constexpr float least_probability = 0.1F;

/// By (n + 1) / 2π cos^n θ about z.
Vec3 cosine_power_direction(double n, const Vec2& u) {
  const double cosine = exponential(logarithm(1 - static_cast<double>(u.x())) / (n + 1));
  const SineCosine phi = sine_cosine(2 * std::numbers::pi * static_cast<double>(u.y()));
  const double sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  return Vec3(static_cast<float>(sine * phi.cosine), static_cast<float>(sine * phi.sine),
              static_cast<float>(cosine))
      .normalized();
}

/// Angles of a pair whose second is above the horizon, with the half vector in the upper
/// hemisphere: every direction of the sphere has exactly one such half vector.
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

/// Sampled half vectors face ω_o, so only those above the horizon count.
double specular_density(const Ggx& model, const Vec3& wo, const Vec3& wi) {
  const Angles a = angles_of(wi, wo);
  if (a.cos_h <= 0)
    return 0;
  const double alpha2 = model.roughness * model.roughness;
  return 0.25 * ggx_distribution(a, alpha2) * ggx_masking_over_cosine(a.cos_o, alpha2);
}

/// Approximate albedo of the specular part.
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
float diffuse_probability(const M& model, const Vec3& wo) {
  const float diffuse = luminance(model.diffuse);
  const float specular = luminance(specular_albedo(model, wo));
  if (specular <= 0)
    return 1;
  if (diffuse <= 0)
    return 0;
  return std::clamp(diffuse / (diffuse + specular), least_probability, 1 - least_probability);
}

} // namespace

AnalyticSampling::AnalyticSampling(const AnalyticBrdf& model, const Vec3& local_wo)
    : m_model(&model), m_wo(local_wo),
      m_diffuse_probability(
          std::visit([&](const auto& m) { return diffuse_probability(m, local_wo); }, model)) {}

Vec3 AnalyticSampling::sample(const Vec2& u) const {
  if (u.x() < m_diffuse_probability)
    return sample_cosine_hemisphere({u.x() / m_diffuse_probability, u.y()});
  // Rounding may not bring the point to the square's edge.
  const float rest =
      std::min((u.x() - m_diffuse_probability) / (1 - m_diffuse_probability), 0x1.fffffep-1F);
  return std::visit([&](const auto& m) { return sample_specular(m, m_wo, Vec2(rest, u.y())); },
                    *m_model);
}

float AnalyticSampling::pdf(const Vec3& local_wi) const {
  const auto diffuse = static_cast<double>(m_diffuse_probability);
  double density = diffuse * static_cast<double>(cosine_hemisphere_pdf(local_wi));
  if (m_diffuse_probability < 1)
    density +=
        (1 - diffuse) *
        std::visit([&](const auto& m) { return specular_density(m, m_wo, local_wi); }, *m_model);
  return static_cast<float>(density);
}

} // namespace haarlight::brdf
