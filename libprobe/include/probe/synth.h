#pragma once
// Synthetic probes: analytic radiance by direction, drawn as angular maps.

#include <wavelet/base/image.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace haarlight::probe {

enum class SceneKind {
  Studio, ///< softboxes of several sizes and colours before a dim gradient
  SunSky, ///< sun and sky of Preetham, Shirley and Smits 1999 over grey ground
  Spheres ///< small bright spheres on a dark background
};

struct SceneOptions {
  double turbidity = 3;      ///< of the sky's haze, 2 (clear) to 10
  double sun_elevation = 35; ///< degrees above the horizon, 0 to 90
  double sun_azimuth = 30;   ///< degrees from forward (−z) towards the right (+x)
  std::uint64_t seed = 1;    ///< random seed of Studio and Spheres
};

/// Where radiance changes within a small angle, so that pixels there need many samples.
struct BrightSpot {
  Vec3 direction;
  float radius = 0; ///< radians
};

/// Radiance by world direction (right +x, up +y, forward −z).
class Scene {
public:
  virtual ~Scene() = default;
  /// @param w unit vector
  virtual Rgb radiance(const Vec3& w) const = 0;
  virtual std::vector<BrightSpot> spots() const { return {}; }
};

/// Radiances are of the order of 1, bright spheres 100 and the sun 10⁴ to 10⁵; for SunSky the unit
/// is 20 kcd/m² of luminance.
std::unique_ptr<Scene> make_scene(SceneKind kind, const SceneOptions& options = {});

/// Draws a scene as an angular map: each pixel is the mean over its part of the disk r ≤ 1, by
/// solid angle, found with many samples where it meets a bright spot. Black outside.
/// @param size pixels along a side, at least 1
Image draw_angular(const Scene& scene, int size);

} // namespace haarlight::probe
