#pragma once
// Samplers that replace the light by representative lights, one direction per region of the sphere.

#include <renderer/light/light.h>
#include <renderer/samplers/sampler.h>

#include <functional>
#include <map>
#include <mutex>

namespace haarlight::renderer {

/// The pixels of a map of the light, all of equal solid angle.
struct LightPixels {
  explicit LightPixels(const Light& light);

  std::size_t count() const { return luminance.size(); }

  int size = 0;          ///< pixels along a side
  float solid_angle = 0; ///< of each
  std::vector<Vec3> directions;
  std::vector<Rgb> radiance;
  std::vector<float> luminance;
};

/// A direction that represents a region of the light.
struct RepresentativeLight {
  Vec3 direction;
  Rgb radiance;          ///< mean over the region
  float solid_angle = 0; ///< of the region
};

/// The weighted mean of directions.
class Centroid {
public:
  void add(const Vec3& direction, float weight);

  /// The mean direction; the direction of the greatest weight if the directions cancel.
  Vec3 direction() const;

  double weight() const { return m_weight; }

private:
  double m_x = 0;
  double m_y = 0;
  double m_z = 0;
  double m_weight = 0;
  float m_most = -1;
  Vec3 m_brightest = Vec3::UnitZ();
};

/// One light per region that is not black, at its centroid weighted by luminance.
/// @param regions index of each pixel's region, < count
std::vector<RepresentativeLight> lights_of_regions(const LightPixels& pixels,
                                                   std::span<const std::uint32_t> regions,
                                                   std::size_t count);

/// Computes at most `count` lights; fewer if there are fewer pixels that are not black.
using MakeRepresentativeLights =
    std::function<std::vector<RepresentativeLight>(const LightPixels& pixels, std::size_t count)>;

/// Samplers that return the same N lights at every point, N being the number of samples:
/// 1/N Σ f L / pdf is Σ f L_k Ω_k. Lights for options.count are computed immediately, others on
/// first use.
std::unique_ptr<SamplerFactory> representative_light_factory(const Light& light,
                                                             MakeRepresentativeLights make,
                                                             const SamplerOptions& options);

} // namespace haarlight::renderer
