#pragma once
// Sampling a reflectance alone: by its model's own routine in the frame of the normal, or by
// descent in the tree of the nearest θ_r cell, in the reflection frame.

#include <renderer/material/material.h>
#include <renderer/samplers/sampler.h>

#include <brdf/analytic.h>
#include <wavelet/tree/descent.h>

#include <span>
#include <vector>

namespace haarlight::renderer {

/// A material's lobe at a point. Densities in sr⁻¹.
class Lobe {
public:
  void prepare(const ShadingPoint& point, const Material& material);

  /// Draws a direction for each point of [0, 1)².
  void sample(std::span<const Vec2> points, std::span<DirectionSample> out);

  float pdf(const Vec3& direction) const;

  /// Sets every sample's pdf to this lobe's at its direction.
  void pdfs(std::span<DirectionSample> samples);

private:
  void sample_tree(std::span<const Vec2> points, std::span<DirectionSample> out);
  void tree_pdfs(std::span<DirectionSample> samples);
  /// As many descents from the root of the tree.
  void start(std::size_t count);

  bool m_has_routine = false;
  brdf::AnalyticSampling m_routine;
  wavelet::TreeDensity m_density;
  Frame m_frame;
  std::vector<Vec2> m_points;
  std::vector<wavelet::TreeDensity> m_densities;
  std::vector<wavelet::Descent> m_descents;
};

} // namespace haarlight::renderer
