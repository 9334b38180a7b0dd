#include <brdf/analytic.h>

#include "analytic/analytic_terms.h"

#include <algorithm>
#include <cmath>

namespace haarlight::brdf {
namespace {

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
  // ω_i·ω_o = cos 2θ_d; what its z product leaves is the tangential part.
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

} // namespace haarlight::brdf
