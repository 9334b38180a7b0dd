#pragma once
// Multiple importance sampling of light and reflectance, whatever the heuristic that weights them.

#include "samplers/lobe_sampling.h"
#include "samplers/technique_split.h"

namespace haarlight::renderer {

/// The first half of a pixel's samples follow the light, the rest the reflectance; a single sample
/// follows either. Of N samples, n_i from density p_i, one of technique i adds w_i f / (n_i p_i) to
/// the estimate, which here is f / (N pdf) with pdf = n_i p_i / (w_i N): Heuristic computes it from
/// the shares s_i = n_i p_i / N.
/// @tparam Heuristic has `static float density(float own, float other)` and `weight(own, other)`,
/// pdf and w_i, own and other being the shares of the technique that drew a sample and of the other
/// one
template <class Heuristic>
class MisSampler : public Sampler {
public:
  explicit MisSampler(const Light& light) : m_light(light) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_lobe.prepare(point, material);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    const TechniqueSplit split = split_of(out.size());
    const std::size_t from_light = split.count(points, out.size());
    m_part = split.fraction();
    sample_light(points, out.first(from_light));
    sample_lobe(points, out.subspan(from_light));
  }

  /// The density that all samples together are drawn with, Σ s_i.
  float pdf(const Vec3& direction, std::size_t count) const override {
    const float part = split_of(count).fraction();
    return part * m_light.pdf(direction) + (1.0F - part) * m_lobe.pdf(direction);
  }

private:
  void sample_light(const PointSource& points, std::span<DirectionSample> out) {
    m_points.resize(out.size());
    m_samples.resize(out.size());
    points.fill(0, m_points);
    m_light.sample(m_points, m_samples);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = {m_samples[i].direction};
    m_lobe.pdfs(out);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = counted(out[i].direction, Technique::First, m_part * m_samples[i].pdf,
                       (1.0F - m_part) * out[i].pdf);
  }

  void sample_lobe(const PointSource& points, std::span<DirectionSample> out) {
    m_points.resize(out.size());
    points.fill(1, m_points);
    m_lobe.sample(m_points, out);
    for (DirectionSample& s : out)
      s = counted(s.direction, Technique::Second, m_part * m_light.pdf(s.direction),
                  (1.0F - m_part) * s.pdf);
  }

  /// A sample of the light (First) or the lobe (Second), given the shares of both.
  static DirectionSample counted(const Vec3& direction, Technique technique, float light,
                                 float lobe) {
    const float pdf = technique == Technique::First ? Heuristic::density(light, lobe)
                                                    : Heuristic::density(lobe, light);
    const float sum = light + lobe;
    if (!(sum > 0))
      return {direction, pdf, technique};
    return {direction, pdf, technique, {light / sum, Heuristic::weight(light, lobe)}};
  }

  static TechniqueSplit split_of(std::size_t count) {
    return count == 1 ? TechniqueSplit{1, 2} : TechniqueSplit{(count + 1) / 2, count};
  }

  const Light& m_light;
  Lobe m_lobe;
  float m_part = 1; ///< of the samples, from the light
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

/// w_i = s_i / Σ s_k: every sample counts with the mean density of all (Veach and Guibas 1995).
struct BalanceHeuristic {
  static float density(float own, float other) { return own + other; }
  static float weight(float own, float other) { return own / (own + other); }
};

} // namespace haarlight::renderer
