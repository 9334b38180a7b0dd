// Two-stage importance sampling (Cline, Egbert, Talbot and Cardon 2006): the probe's picture is
// divided by the reflectance at each point, a region is chosen by the product of both, and a place
// in it by the light's summed-area table.

#include "samplers/kinds.h"
#include "samplers/light_partition.h"
#include "samplers/lobe_sampling.h"

#include <wavelet/square/sphere_map.h>

namespace haarlight::renderer {
namespace {

/// A light that is a tree alone, as a picture of its finest squares.
probe::Probe picture_of(const wavelet::TreeView& tree) {
  const int size = 1 << tree.levels;
  Image image(size, size);
  const auto side = static_cast<float>(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      image.set(
          x, y,
          tree.value((static_cast<float>(x) + 0.5F) / side, (static_cast<float>(y) + 0.5F) / side)
              .max(0.0F));
  return {image, probe::Mapping::Octahedral};
}

std::shared_ptr<const LightPicture> light_picture(const Light& light) {
  if (light.probe() != nullptr)
    return std::make_shared<const LightPicture>(*light.probe());
  return std::make_shared<const LightPicture>(picture_of(light.tree()));
}

class TwoStageSampler : public Sampler {
public:
  TwoStageSampler(std::shared_ptr<const LightPicture> picture, int regions)
      : m_picture(std::move(picture)), m_regions(static_cast<std::size_t>(regions)),
        m_partition(*m_picture), m_mark_points(marks_of_lobe), m_mark_samples(marks_of_lobe) {
    fill_points(Points::Sobol, 0, 0, m_mark_points);
  }

  /// The partition's marks are the mirror direction and what the reflectance's own tree draws.
  void prepare(const ShadingPoint& point, const Material& material) override {
    m_lobe.prepare(point, material);
    m_lobe.sample(m_mark_points, m_mark_samples);
    m_marks.assign(1, point.reflection.frame.n);
    for (const DirectionSample& s : m_mark_samples)
      m_marks.push_back(s.direction);
    m_partition.build(point, material, m_marks, m_regions);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_points.resize(out.size());
    points.fill(2, m_points);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec2 uv = m_partition.sample(m_points[i], out[i].pdf);
      out[i].direction = probe::image_to_direction(m_picture->mapping, uv);
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_partition.pdf(probe::direction_to_image(m_picture->mapping, direction));
  }

  std::size_t leaves() const override { return m_partition.regions(); }

private:
  static constexpr std::size_t marks_of_lobe = 15;

  std::shared_ptr<const LightPicture> m_picture;
  std::size_t m_regions;
  LightPartition m_partition;
  Lobe m_lobe;
  std::vector<Vec2> m_mark_points;
  std::vector<DirectionSample> m_mark_samples;
  std::vector<Vec3> m_marks;
  std::vector<Vec2> m_points;
};

} // namespace

std::unique_ptr<SamplerFactory> make_two_stage_factory(const LoadedScene& scene,
                                                       const SamplerOptions& options) {
  return simple_factory<TwoStageSampler>(light_picture(scene.light()), options.regions);
}

} // namespace haarlight::renderer
