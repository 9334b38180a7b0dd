#include <probe/synth.h>

#include "synth/sky.h"

#include "mapping/mapping_lanes.h"

#include <wavelet/base/hash.h>
#include <wavelet/base/parallel.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace haarlight::probe {
namespace {

/// Uniform numbers by SplitMix64, the same everywhere.
class Chance {
public:
  explicit Chance(std::uint64_t seed) : m_state(seed) {}

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
  explicit Studio(Chance chance) {
    for (int i = 0; i < 5; ++i) {
      const float azimuth = 2 * pi * (static_cast<float>(i) + chance.between(-0.3F, 0.3F)) / 5;
      add_box(direction_at(azimuth, chance.between(0.1F, 1.1F)), chance);
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

  void add_box(const Vec3& direction, Chance& chance) {
    Box box;
    const Vec3 side = Vec3::UnitY().cross(direction).normalized();
    box.frame = {side, direction.cross(side), direction};
    box.half_width = chance.between(0.04F, 0.35F);
    box.half_height = chance.between(0.04F, 0.35F);
    const float warmth = chance.between(0.0F, 1.0F);
    const float power = chance.between(0.15F, 0.6F) / (box.half_width * box.half_height);
    box.radiance = power * Rgb(1, 0.95F - 0.25F * warmth, 0.95F - 0.55F * warmth);
    m_boxes.push_back(box);
  }

  std::vector<Box> m_boxes;
};

class Spheres : public Scene {
public:
  explicit Spheres(Chance chance) {
    for (int i = 0; i < 12; ++i) {
      const float sine = chance.between(-0.6F, 1.0F);
      const float elevation = 0.5F * pi - arccosine(sine);
      const float radius = (i % 3 == 0 ? 0.35F : (i % 3 == 1 ? 0.8F : 2.0F)) * pi / 180;
      const Rgb colour(1, chance.between(0.6F, 1.0F), chance.between(0.4F, 1.0F));
      const float power = chance.between(0.02F, 0.1F);
      m_lamps.push_back({direction_at(chance.between(-pi, pi), elevation), radius,
                         colour * power / (pi * radius * radius)});
    }
  }

  Rgb radiance(const Vec3& w) const override {
    for (const Lamp& lamp : m_lamps)
      if ((w - lamp.direction).squaredNorm() < lamp.radius * lamp.radius)
        return lamp.radiance;
    return {0.004F, 0.004F, 0.005F};
  }

  std::vector<BrightSpot> spots() const override {
    std::vector<BrightSpot> result;
    for (const Lamp& lamp : m_lamps)
      result.push_back({lamp.direction, lamp.radius});
    return result;
  }

private:
  struct Lamp {
    Vec3 direction;
    float radius; ///< of the disk, as a chord of the unit sphere
    Rgb radiance;
  };
  std::vector<Lamp> m_lamps;
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
    return std::make_unique<Studio>(Chance(options.seed));
  case SceneKind::Spheres:
    return std::make_unique<Spheres>(Chance(options.seed));
  case SceneKind::SunSky:
    return make_sun_sky(direction_at(static_cast<float>(options.sun_azimuth) * degree,
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
