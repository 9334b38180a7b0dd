#include <probe/synth.h>

#include "file/colour_space.h"
#include "mapping/mapping_lanes.h"

#include <wavelet/base/elementary.h>
#include <wavelet/base/hash.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace haarlight::probe {
namespace {

/// Uniform numbers by SplitMix64, the same everywhere.
class Random {
public:
  explicit Random(std::uint64_t seed) : m_state(seed) {}

  float between(float low, float high) {
    const std::uint64_t z = splitmix64(m_state);
    m_state += splitmix64_increment;
    return low + (high - low) * static_cast<float>(z >> 40U) * 0x1p-24F;
  }

private:
  std::uint64_t m_state;
};

/// Unit vector at an azimuth from forward towards the right and an elevation, in radians.
Vec3 direction_at(float azimuth, float elevation) {
  float sin_a = 0;
  float cos_a = 0;
  float sin_e = 0;
  float cos_e = 0;
  sine_cosine(azimuth, sin_a, cos_a);
  sine_cosine(elevation, sin_e, cos_e);
  return {sin_a * cos_e, sin_e, -cos_a * cos_e};
}

class Studio : public Scene {
public:
  explicit Studio(Random random) {
    for (int i = 0; i < 5; ++i) {
      const float azimuth = 2 * pi * (static_cast<float>(i) + random.between(-0.3F, 0.3F)) / 5;
      add_box(direction_at(azimuth, random.between(0.1F, 1.1F)), random);
    }
  }

  Rgb radiance(const Vec3& w) const override {
    for (const Box& box : m_boxes) {
      const Vec3 local = box.frame.to_local(w);
      if (local.z() > 0 && std::abs(local.x()) < box.half_width * local.z() &&
          std::abs(local.y()) < box.half_height * local.z())
        return box.radiance;
    }
    const float height = 0.5F * (1 + w.y());
    return Rgb(0.02F, 0.022F, 0.026F) + height * height * Rgb(0.12F, 0.12F, 0.13F);
  }

  std::vector<BrightSpot> spots() const override {
    std::vector<BrightSpot> result;
    for (const Box& box : m_boxes)
      result.push_back({box.frame.n, std::hypot(box.half_width, box.half_height)});
    return result;
  }

private:
  /// A rectangle on the plane at distance 1.
  struct Box {
    Frame frame;
    float half_width;
    float half_height;
    Rgb radiance;
  };

  void add_box(const Vec3& direction, Random& random) {
    Box box;
    const Vec3 side = Vec3::UnitY().cross(direction).normalized();
    box.frame = {side, direction.cross(side), direction};
    box.half_width = random.between(0.04F, 0.35F);
    box.half_height = random.between(0.04F, 0.35F);
    const float warmth = random.between(0.0F, 1.0F);
    const float power = random.between(0.15F, 0.6F) / (box.half_width * box.half_height);
    box.radiance = power * Rgb(1, 0.95F - 0.25F * warmth, 0.95F - 0.55F * warmth);
    m_boxes.push_back(box);
  }

  std::vector<Box> m_boxes;
};

class Spheres : public Scene {
public:
  explicit Spheres(Random random) {
    for (int i = 0; i < 12; ++i) {
      const float sine = random.between(-0.6F, 1.0F);
      const float elevation = 0.5F * pi - arccosine(sine);
      const float radius = (i % 3 == 0 ? 0.35F : (i % 3 == 1 ? 0.8F : 2.0F)) * pi / 180;
      const Rgb colour(1, random.between(0.6F, 1.0F), random.between(0.4F, 1.0F));
      const float power = random.between(0.02F, 0.1F);
      m_lights.push_back({direction_at(random.between(-pi, pi), elevation), radius,
                          colour * power / (pi * radius * radius)});
    }
  }

  Rgb radiance(const Vec3& w) const override {
    for (const SphereLight& light : m_lights)
      if ((w - light.direction).squaredNorm() < light.radius * light.radius)
        return light.radiance;
    return {0.004F, 0.004F, 0.005F};
  }

  std::vector<BrightSpot> spots() const override {
    std::vector<BrightSpot> result;
    for (const SphereLight& light : m_lights)
      result.push_back({light.direction, light.radius});
    return result;
  }

private:
  struct SphereLight {
    Vec3 direction;
    float radius; ///< of the disk, as a chord of the unit sphere
    Rgb radiance;
  };
  std::vector<SphereLight> m_lights;
};

// The daylight model of Preetham, Shirley and Smits, "A practical analytic model for daylight",
// 1999.

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
  return convert_colour(rec709_from_xyz(), {big_x, luminance_y, big_z}).max(0).cast<float>();
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

/// Samples along a side of a pixel of this angular size: enough to draw the edges of spots it
/// meets.
int samples_along(const std::vector<BrightSpot>& spots, const Vec3& w, float pixel) {
  float wanted = 4;
  for (const BrightSpot& spot : spots)
    if ((w - spot.direction).norm() < spot.radius + 0.75F * pixel)
      wanted = std::max({wanted, 16.0F, 12 * pixel / spot.radius});
  return static_cast<int>(std::min(wanted, 256.0F));
}

Rgb draw_pixel(const Scene& scene, const std::vector<BrightSpot>& spots, int x, int y, int size) {
  const float scale = 1.0F / static_cast<float>(size);
  const Vec2 corner(static_cast<float>(x) * scale, static_cast<float>(y) * scale);
  const Vec3 middle = image_to_direction(Mapping::Angular, corner + Vec2(0.5F, 0.5F) * scale);
  const int along = samples_along(spots, middle, 2 * pi * scale);
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  double weights = 0;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < along; ++i) {
      const Vec2 inside(static_cast<float>(i) + 0.5F, static_cast<float>(j) + 0.5F);
      const Vec2 uv = corner + inside * (scale / static_cast<float>(along));
      if (!in_map(Mapping::Angular, uv))
        continue;
      const double weight = solid_angle_density(Mapping::Angular, uv);
      sum += weight * scene.radiance(image_to_direction(Mapping::Angular, uv)).cast<double>();
      weights += weight;
    }
  return weights > 0 ? Rgb((sum / weights).cast<float>()) : Rgb(0, 0, 0);
}

} // namespace

std::unique_ptr<Scene> make_scene(SceneKind kind, const SceneOptions& options) {
  constexpr auto degree = static_cast<float>(pi / 180);
  switch (kind) {
  case SceneKind::Studio:
    return std::make_unique<Studio>(Random(options.seed));
  case SceneKind::Spheres:
    return std::make_unique<Spheres>(Random(options.seed));
  case SceneKind::SunSky:
    return std::make_unique<SunSky>(
        direction_at(static_cast<float>(options.sun_azimuth) * degree,
                     static_cast<float>(options.sun_elevation) * degree),
        options.turbidity);
  }
  std::abort();
}

Image draw_angular(const Scene& scene, int size) {
  assert(size >= 1);
  Image image(size, size);
  const std::vector<BrightSpot> spots = scene.spots();
  parallel_for(static_cast<std::size_t>(size), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < size; ++x)
      image.set(x, y, draw_pixel(scene, spots, x, y, size));
  });
  return image;
}

} // namespace haarlight::probe
