#include "samplers/lobe_peaks.h"

#include "samplers/lobe_sampling.h"

#include <wavelet/base/parallel.h>
#include <wavelet/base/trigonometry.h>

#include <algorithm>

namespace haarlight::renderer {
namespace {

constexpr std::size_t directions_tried = 1024;

ShadingPoint point_at(float theta_r) {
  float s = 0;
  float c = 1;
  sine_cosine(theta_r, s, c);
  return shading_point(Vec3::UnitZ(), Vec3(s, 0, c));
}

LobePeak find_peak(const ShadingPoint& point, const Material& material) {
  std::vector<Vec2> points(directions_tried);
  fill_points(Points::Sobol, 0, 0, points);
  std::vector<DirectionSample> samples(directions_tried);
  Lobe lobe;
  lobe.prepare(point, material);
  lobe.sample(points, samples);
  std::vector<Vec3> directions;
  directions.reserve(samples.size() + 1);
  for (const DirectionSample& s : samples)
    directions.push_back(s.direction);
  directions.push_back(point.reflection.frame.n);
  std::vector<Rgb> values(directions.size());
  material.evaluate(point, directions, values);
  LobePeak peak;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const float value = luminance(values[i]);
    if (i < samples.size() && samples[i].pdf > 0)
      peak.albedo += value / samples[i].pdf / static_cast<float>(directions_tried);
    peak.value = std::max(peak.value, value);
  }
  return peak;
}

} // namespace

LobePeaks::LobePeaks(const LoadedScene& scene)
    : m_materials(scene.materials()), m_peaks(m_materials.size() * cells) {
  parallel_for(m_peaks.size(), [&](std::size_t i) {
    const float theta_r = (static_cast<float>(i % cells) + 0.5F) * (0.5F * pi / cells);
    m_peaks[i] = find_peak(point_at(theta_r), m_materials[i / cells]);
  });
}

const LobePeak& LobePeaks::at(const ShadingPoint& point, const Material& material) const {
  const float theta_r = arctangent(point.reflection.sin_theta_r, point.reflection.cos_theta_r);
  const int cell = std::clamp(static_cast<int>(theta_r * (2.0F * cells / pi)), 0, cells - 1);
  const auto index = static_cast<std::size_t>(&material - m_materials.data());
  return m_peaks[index * cells + static_cast<std::size_t>(cell)];
}

} // namespace haarlight::renderer
