// Two-stage importance sampling (Cline, Egbert, Talbot and Cardon 2006): the probe's picture is
// divided by the reflectance at each point, a region is chosen by the product of both, and a place
// in it by the light's summed-area table.

#include "kinds.h"
#include "light_partition.h"

#include <wavelet/sphere_map.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

/// A light that is a tree alone, as a picture of its finest squares.
probe::Probe picture_of(const wavelet::TreeView& tree) {
  const int size = 1 << tree.levels;
  probe::Image image(size, size);
  const auto side = static_cast<float>(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      image.set(
          x, y,
          tree.value((static_cast<float>(x) + 0.5F) / side, (static_cast<float>(y) + 0.5F) / side)
              .max(0.0F));
  return {image, probe::Mapping::Octahedral};
}

LightPicture light_picture(const Light& light) {
  if (light.probe() != nullptr)
    return LightPicture(*light.probe());
  return LightPicture(picture_of(light.tree()));
}

/// What all threads share.
struct SharedParts {
  LightPicture picture;
  LobePeaks peaks;

  explicit SharedParts(const LoadedScene& scene)
      : picture(light_picture(scene.light())), peaks(scene) {}
};

class TwoStageSampler : public Sampler {
public:
  TwoStageSampler(std::shared_ptr<const SharedParts> shared, int regions)
      : m_shared(std::move(shared)), m_regions(static_cast<std::size_t>(regions)),
        m_partition(m_shared->picture) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_partition.build(point, material, m_shared->peaks.at(point, material), m_regions);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec2 uv = m_partition.sample(m_points[i], out[i].pdf);
      out[i].direction = probe::image_to_direction(m_shared->picture.mapping, uv);
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_partition.pdf(probe::direction_to_image(m_shared->picture.mapping, direction));
  }

  std::size_t leaves() const override { return m_partition.regions(); }

private:
  std::shared_ptr<const SharedParts> m_shared;
  std::size_t m_regions;
  LightPartition m_partition;
  std::vector<Vec2> m_points;
};

} // namespace

std::unique_ptr<SamplerFactory> make_two_stage_factory(const LoadedScene& scene,
                                                       const SamplerOptions& options) {
  return simple_factory<TwoStageSampler>(std::make_shared<const SharedParts>(scene),
                                         options.regions);
}

} // namespace haarlight::renderer
