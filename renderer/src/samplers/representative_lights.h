#pragma once
// Lamps in place of a light: what all samplers share that stand one direction for each region of
// the sphere.

#include <renderer/light/light.h>
#include <renderer/samplers/sampler.h>

#include <functional>
#include <map>
#include <mutex>

namespace haarlight::renderer {

/// The light as pixels of equal solid angle, those of a map of the square.
struct LightPixels {
  explicit LightPixels(const Light& light);

  std::size_t count() const { return luminance.size(); }

  int size = 0;          ///< pixels along a side
  float solid_angle = 0; ///< of each
  std::vector<Vec3> directions;
  std::vector<Rgb> radiance;
  std::vector<float> luminance;
};

/// A direction that stands for a region.
struct RepresentativeLight {
  Vec3 direction;
  Rgb radiance;          ///< mean over the region
  float solid_angle = 0; ///< of the region
};

/// A sum over directions in which the brighter count more, and what becomes of it.
class Centroid {
public:
  void add(const Vec3& direction, float weight);

  /// The mean direction; that of the greatest weight if the others cancel it out.
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

/// One lamp for each region that shines, at its centroid by luminance.
/// @param regions of each pixel, below `count`
std::vector<RepresentativeLight> lights_of_regions(const LightPixels& pixels,
                                                   std::span<const std::uint32_t> regions,
                                                   std::size_t count);

/// Makes at most `count` lamps; the fewer the light has pixels or shines at all.
using MakeRepresentativeLights =
    std::function<std::vector<RepresentativeLight>(const LightPixels& pixels, std::size_t count)>;

/// Samplers that return the same lamps for every point, as many as are asked for: 1/N Σ f L / pdf
/// is Σ f L_k Ω_k over the lamps. Lamps for options.count are made now, others when first asked
/// for.
std::unique_ptr<SamplerFactory> representative_light_factory(const Light& light,
                                                             MakeRepresentativeLights make,
                                                             const SamplerOptions& options);

} // namespace haarlight::renderer
