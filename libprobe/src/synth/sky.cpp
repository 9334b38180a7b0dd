#include "synth/sky.h"

#include "file/colour_space.h"

#include <wavelet/base/elementary.h>
#include <wavelet/base/trigonometry.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace haarlight::probe {
namespace {

/// One unit of radiance, in kcd/m² of luminance.
constexpr double unit = 20;
/// Angular radius of the sun's disk: 0.53° across.
constexpr float sun_radius = 0.265F * pi / 180;
constexpr double ground_albedo = 0.2;

/// Perez et al.: relative luminance by the zenith angle θ and the angle γ from the sun.
struct Perez {
  double a, b, c, d, e;

  double operator()(double cos_theta, double gamma, double cos_gamma) const {
    return (1 + a * exponential(b / std::max(cos_theta, 0.01))) *
           (1 + c * exponential(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

/// Zenith chromaticity: turbidity² , turbidity, 1 by powers of the sun's zenith angle.
double zenith_chromaticity(const double (&m)[3][4], double t, double s) {
  const double powers[4] = {s * s * s, s * s, s, 1};
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    sum += (t * t * m[0][i] + t * m[1][i] + m[2][i]) * powers[i];
  return sum;
}

constexpr double zenith_x[3][4] = {{0.00166, -0.00375, 0.00209, 0},
                                   {-0.02903, 0.06377, -0.03202, 0.00394},
                                   {0.11693, -0.21196, 0.06052, 0.25886}};
constexpr double zenith_y[3][4] = {{0.00275, -0.00610, 0.00317, 0},
                                   {-0.04214, 0.08970, -0.04153, 0.00516},
                                   {0.15346, -0.26756, 0.06670, 0.26688}};

/// CIE xyY to Rec. 709.
Rgb rgb_of(double x, double y, double luminance_y) {
  const double big_x = x / y * luminance_y;
  const double big_z = (1 - x - y) / y * luminance_y;
  return rec709_from_xyz({big_x, luminance_y, big_z}).max(0).cast<float>();
}

class SunSky : public Scene {
public:
  SunSky(const Vec3& to_sun, double turbidity) : m_sun(to_sun), m_t(turbidity) {
    m_theta_s = arccosine(to_sun.y());
    set_distributions();
    m_sun_radiance = sun_radiance();
    m_ground = ground_radiance();
  }

  Rgb radiance(const Vec3& w) const override {
    if (w.y() < 0)
      return m_ground;
    const bool on_sun = (w - m_sun).squaredNorm() < sun_radius * sun_radius;
    return on_sun ? Rgb(m_sun_radiance + sky(w)) : sky(w);
  }

  std::vector<BrightSpot> spots() const override { return {{m_sun, sun_radius}}; }

private:
  void set_distributions() {
    const double t = m_t;
    m_perez = {Perez{0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251,
                     0.1206 * t - 2.5771, -0.0670 * t + 0.3703},
               Perez{-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125,
                     -0.0641 * t - 0.8989, -0.0033 * t + 0.0452},
               Perez{-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102,
                     -0.0441 * t - 1.6537, -0.0109 * t + 0.0529}};
    float sine = 0;
    float cosine = 0;
    sine_cosine(static_cast<float>((4.0 / 9 - t / 120) * (pi - 2 * m_theta_s)), sine, cosine);
    const double zenith = (4.0453 * t - 4.9710) * sine / cosine - 0.2155 * t + 2.4192;
    const std::array<double, 3> at_zenith = {std::max(zenith, 0.1) / unit,
                                             zenith_chromaticity(zenith_x, t, m_theta_s),
                                             zenith_chromaticity(zenith_y, t, m_theta_s)};
    const double cos_s = m_sun.y();
    for (std::size_t i = 0; i < 3; ++i)
      m_scale[i] = at_zenith[i] / m_perez[i](1, m_theta_s, cos_s);
  }

  Rgb sky(const Vec3& w) const {
    const double cos_gamma = std::clamp(w.dot(m_sun), -1.0F, 1.0F);
    const double gamma = arccosine(static_cast<float>(cos_gamma));
    std::array<double, 3> value{};
    for (std::size_t i = 0; i < 3; ++i)
      value[i] = m_scale[i] * m_perez[i](w.y(), gamma, cos_gamma);
    return rgb_of(value[1], value[2], value[0]);
  }

  /// Sunlight after the air's molecules (Rayleigh) and haze (Ångström) at 610, 550 and 465 nm.
  Rgb sun_radiance() const {
    constexpr double luminance_outside = 1.9e6;              // kcd/m²
    constexpr double wavelengths[3] = {0.610, 0.550, 0.465}; // µm
    const double degrees = m_theta_s * 180 / std::numbers::pi;
    const double above = std::max(93.885 - degrees, 3.885);
    const double air_mass = 1 / (std::max<double>(m_sun.y(), 0) + 0.15 * power(above, -1.253));
    const double haze = 0.04608365822050 * m_t - 0.04586025928522;
    Rgb result;
    for (int c = 0; c < 3; ++c) {
      const double depth =
          0.008735 * power(wavelengths[c], -4.08) + haze * power(wavelengths[c], -1.3);
      result[c] = static_cast<float>(luminance_outside / unit * exponential(-depth * air_mass));
    }
    return result;
  }

  /// A diffuse ground under sun and sky.
  Rgb ground_radiance() const {
    constexpr int rings = 16;
    constexpr int sectors = 32;
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (int j = 0; j < rings; ++j)
      for (int i = 0; i < sectors; ++i) {
        const float height = (static_cast<float>(j) + 0.5F) / rings;
        float sine = 0;
        float cosine = 0;
        sine_cosine(2 * pi * (static_cast<float>(i) + 0.5F) / sectors, sine, cosine);
        const float planar = std::sqrt(1 - height * height);
        sum += height * sky({planar * sine, height, -planar * cosine}).cast<double>();
      }
    const Eigen::Array3d from_sky = sum * (2 * std::numbers::pi / (rings * sectors));
    const double sun_angle = std::numbers::pi * sun_radius * sun_radius;
    const Eigen::Array3d from_sun =
        m_sun_radiance.cast<double>() * (sun_angle * std::max<double>(m_sun.y(), 0));
    return ((from_sky + from_sun) * (ground_albedo / std::numbers::pi)).cast<float>();
  }

  Vec3 m_sun;
  double m_t;
  double m_theta_s;
  std::array<Perez, 3> m_perez{};
  std::array<double, 3> m_scale{};
  Rgb m_sun_radiance;
  Rgb m_ground;
};

} // namespace

std::unique_ptr<Scene> make_sun_sky(const Vec3& to_sun, double turbidity) {
  return std::make_unique<SunSky>(to_sun, turbidity);
}

} // namespace haarlight::probe
