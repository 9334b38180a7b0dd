#pragma once
// Samples of the distant light at the points seen by pixels, by the chosen sampler.

#include "film/film_rendering.h"
#include "film/pixel_sums.h"

#include <optional>
#include <vector>

namespace haarlight::renderer {

/// One per thread. Sample i contributes weight(i), if visible(i), divided by the number of samples,
/// to ∫ f_r L v cos dω.
class LightSamples {
public:
  LightSamples(const LoadedScene& scene, const RenderOptions& options,
               const RenderFactories& factories);

  void reset();

  /// Sets the shading point. `seen` must live until the next call.
  void prepare(const PixelHit& seen, ShadingCost& cost);

  /// L_ns, for estimators that use it.
  std::optional<Rgb> unshadowed() const;

  /// Draws a pass's samples for the point.
  void sample(const Pass& pass);

  /// f_r L cos / p; 0 for samples without a direction.
  Rgb weight(std::size_t i) const;

  /// Traces the ray of sample i. False where weight() is 0.
  bool visible(std::size_t i) const;

  /// Traces the ray of sample i even if its weight is 0; no ray if its direction is below the
  /// horizon.
  std::optional<bool> unoccluded(std::size_t i) const;

  float pdf(std::size_t i) const { return m_directions[i].pdf; }
  Technique technique(std::size_t i) const { return m_directions[i].technique; }

  /// @param weight as weight(i)
  Contribution contribution(std::size_t i, const Rgb& weight, bool visible) const {
    const DirectionSample& s = m_directions[i];
    return {static_cast<double>(luminance(weight)), visible, s.technique, s.first};
  }

  /// Variances of Σ w v and Σ w over the pass's samples.
  /// @param samples all of them
  SumVariance variance_of_sums(std::span<const Contribution> samples);

private:
  bool trace(std::size_t i) const;

  const LoadedScene& m_scene;
  const RenderOptions& m_options;
  std::unique_ptr<Sampler> m_sampler;
  std::unique_ptr<Sampler> m_integrator; ///< computes L_ns, where the sampler does not
  const PixelHit* m_seen = nullptr;
  ShadingPoint m_point;
  std::vector<DirectionSample> m_directions;
  std::vector<Vec3> m_candidates;
  std::vector<Rgb> m_reflected; ///< f_r L cos
  std::vector<Rgb> m_radiance;
  std::vector<std::uint8_t> m_visible; ///< of the pass's samples
};

} // namespace haarlight::renderer
