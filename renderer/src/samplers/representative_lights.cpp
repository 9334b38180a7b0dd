#include "samplers/representative_lights.h"

#include <wavelet/square/sphere_map.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

/// About the resolution of a probe of 1000 pixels.
constexpr int max_map_size = 512;
/// For coarser probes, so that regions can be smaller than one of their pixels.
constexpr int min_map_size = 128;

/// Lights as samples; if there are fewer lights than samples, the remaining samples have pdf 0.
struct LightSet {
  LightSet(std::span<const RepresentativeLight> lights, std::size_t count)
      : samples(count, {Vec3::UnitZ(), 0, Technique::Fixed}), radiance(count, Rgb::Zero()) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
      samples[i] = {lights[i].direction, 1 / (static_cast<float>(count) * lights[i].solid_angle),
                    Technique::Fixed};
      radiance[i] = lights[i].radiance;
    }
  }

  std::vector<DirectionSample> samples;
  std::vector<Rgb> radiance;
};

/// The sets of lights by count; shared by threads.
class LightSetCache {
public:
  LightSetCache(const Light& light, MakeRepresentativeLights make)
      : m_pixels(light), m_make(std::move(make)) {}

  const LightSet& of(std::size_t count) const {
    const std::lock_guard lock(m_mutex);
    auto found = m_sets.find(count);
    if (found == m_sets.end())
      found = m_sets.emplace(count, LightSet(m_make(m_pixels, count), count)).first;
    return found->second;
  }

private:
  LightPixels m_pixels;
  MakeRepresentativeLights m_make;
  mutable std::mutex m_mutex;
  mutable std::map<std::size_t, LightSet> m_sets;
};

class RepresentativeLightSampler : public Sampler {
public:
  explicit RepresentativeLightSampler(std::shared_ptr<const LightSetCache> sets)
      : m_sets(std::move(sets)) {}

  void prepare(const ShadingPoint& /*point*/, const Material& /*material*/) override {}

  void sample(const PointSource& /*points*/, std::span<DirectionSample> out) override {
    if (m_lights == nullptr || m_lights->samples.size() != out.size())
      m_lights = &m_sets->of(out.size());
    std::ranges::copy(m_lights->samples, out.begin());
  }

  /// That of the nearest light, whose region most likely contains the direction.
  float pdf(const Vec3& direction, std::size_t count) const override {
    float most = -2;
    float result = 0;
    for (const DirectionSample& s : m_sets->of(count).samples) {
      const float cosine = s.direction.dot(direction);
      if (s.pdf > 0 && cosine > most) {
        most = cosine;
        result = s.pdf;
      }
    }
    return result;
  }

  void radiance(const Light& /*light*/, std::span<const Vec3> /*directions*/,
                std::span<Rgb> out) const override {
    std::copy_n(m_lights->radiance.begin(), out.size(), out.begin());
  }

private:
  std::shared_ptr<const LightSetCache> m_sets;
  const LightSet* m_lights = nullptr; ///< of the last count
};

class RepresentativeLightFactory : public SamplerFactory {
public:
  RepresentativeLightFactory(const Light& light, MakeRepresentativeLights make, std::size_t count)
      : m_sets(std::make_shared<LightSetCache>(light, std::move(make))) {
    if (count > 0)
      m_sets->of(count);
  }

  std::unique_ptr<Sampler> make(std::size_t /*count*/) const override {
    return std::make_unique<RepresentativeLightSampler>(m_sets);
  }

private:
  std::shared_ptr<const LightSetCache>
      m_sets; ///< shared with samplers, which may outlive the factory
};

} // namespace

LightPixels::LightPixels(const Light& light) {
  const wavelet::Map map = light.map(max_map_size, min_map_size);
  size = map.size;
  const auto side = static_cast<float>(size);
  solid_angle = wavelet::sphere_area / (side * side);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec2 centre((static_cast<float>(x) + 0.5F) / side,
                        (static_cast<float>(y) + 0.5F) / side);
      directions.push_back(wavelet::square_to_sphere(centre));
      radiance.push_back(map.at(x, y));
      luminance.push_back(haarlight::luminance(radiance.back()));
    }
}

void Centroid::add(const Vec3& direction, float weight) {
  const auto w = static_cast<double>(weight);
  m_x += w * static_cast<double>(direction.x());
  m_y += w * static_cast<double>(direction.y());
  m_z += w * static_cast<double>(direction.z());
  m_weight += w;
  if (weight > m_most) {
    m_most = weight;
    m_brightest = direction;
  }
}

Vec3 Centroid::direction() const {
  const double length = std::sqrt(m_x * m_x + m_y * m_y + m_z * m_z);
  if (length <= 1e-4 * m_weight)
    return m_brightest;
  return {static_cast<float>(m_x / length), static_cast<float>(m_y / length),
          static_cast<float>(m_z / length)};
}

std::vector<RepresentativeLight> lights_of_regions(const LightPixels& pixels,
                                                   std::span<const std::uint32_t> regions,
                                                   std::size_t count) {
  struct Sums {
    Centroid centroid;
    Eigen::Array3d radiance = Eigen::Array3d::Zero();
    std::size_t pixels = 0;
  };
  std::vector<Sums> sums(count);
  for (std::size_t i = 0; i < pixels.count(); ++i) {
    Sums& region = sums[regions[i]];
    region.centroid.add(pixels.directions[i], pixels.luminance[i]);
    region.radiance += pixels.radiance[i].cast<double>();
    ++region.pixels;
  }
  std::vector<RepresentativeLight> result;
  for (const Sums& region : sums)
    if (region.centroid.weight() > 0) {
      const auto area = static_cast<double>(region.pixels);
      result.push_back({region.centroid.direction(), (region.radiance / area).cast<float>(),
                        static_cast<float>(area) * pixels.solid_angle});
    }
  return result;
}

std::unique_ptr<SamplerFactory> representative_light_factory(const Light& light,
                                                             MakeRepresentativeLights make,
                                                             const SamplerOptions& options) {
  return std::make_unique<RepresentativeLightFactory>(light, std::move(make), options.count);
}

} // namespace haarlight::renderer
