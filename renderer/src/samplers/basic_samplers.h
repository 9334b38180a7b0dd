#pragma once
// The techniques that other samplers are composed of: the light alone, the reflectance alone, and
// multiple importance sampling of both. Directions are in the light's frame, densities in sr⁻¹.

#include <renderer/material/material.h>
#include <renderer/samplers/sampler.h>

#include <brdf/analytic.h>
#include <wavelet/tree/descent.h>

#include <span>
#include <vector>

namespace haarlight::renderer {

/// How the samples of a pixel are divided between two techniques. The numbers are fixed, except
/// that a single sample chooses its technique at random; its density is the mixture's in both
/// cases.
struct TechniqueSplit {
  std::size_t part = 0;  ///< samples of the technique
  std::size_t whole = 1; ///< all samples if there are several

  float fraction() const { return static_cast<float>(part) / static_cast<float>(whole); }

  /// @param count number of all samples
  /// @return number of samples of the technique
  std::size_t count(const PointSource& points, std::size_t count) const {
    if (count != 1)
      return part;
    constexpr std::uint32_t dimension = 5; // not used for directions
    const std::uint32_t choice = hash_words(hash_words(points.key, dimension), points.first);
    return choice % whole < part ? 1 : 0;
  }
};

/// Samples the light by the distribution of its pixels.
class LightSampler : public Sampler {
public:
  explicit LightSampler(const Light& light) : m_light(light) {}

  void prepare(const ShadingPoint& /*point*/, const Material& /*material*/) override {}
  void sample(const PointSource& points, std::span<DirectionSample> out) override;
  float pdf(const Vec3& direction) const { return m_light.pdf(direction); }
  float pdf(const Vec3& direction, std::size_t /*count*/) const override { return pdf(direction); }

private:
  const Light& m_light;
  std::vector<Vec2> m_points;
  std::vector<probe::LightSample> m_samples;
};

/// Samples the reflectance at a point: by its model's own routine in the frame of the normal, or by
/// descent in the tree of the nearest θ_r cell in the reflection frame.
class Lobe {
public:
  void prepare(const ShadingPoint& point, const Material& material);

  /// Draws a direction for each point of [0, 1)².
  void sample(std::span<const Vec2> points, std::span<DirectionSample> out);

  float pdf(const Vec3& direction) const;

  /// Sets every sample's pdf to the lobe's density at the sample's direction.
  void pdfs(std::span<DirectionSample> samples);

private:
  bool m_has_routine = false;
  brdf::AnalyticSampling m_routine;
  wavelet::TreeDensity m_density;
  Frame m_frame;
  std::vector<Vec2> m_points;
  std::vector<wavelet::TreeDensity> m_densities;
  std::vector<wavelet::Descent> m_descents;
};

/// Weights of multiple importance sampling, from the shares s_i = n_i p_i / N of N samples.
enum class Heuristic {
  Balance, ///< w_i = s_i / Σ s_k (Veach and Guibas 1995)
  Power    ///< w_i = s_i² / Σ s_k², β = 2 (Veach 1997, section 9.2.3)
};

/// The first half of a pixel's samples follows the light, the rest the reflectance; a single sample
/// follows either. Of N samples, n_i with density p_i, one of technique i adds w_i f / (n_i p_i) to
/// the estimate, which is f / (N pdf) with pdf = s_i / w_i.
class MisSampler : public Sampler {
public:
  MisSampler(const Light& light, Heuristic heuristic) : m_light(light), m_heuristic(heuristic) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_lobe.prepare(point, material);
  }
  void sample(const PointSource& points, std::span<DirectionSample> out) override;
  /// Density of all samples together, Σ s_i.
  float pdf(const Vec3& direction, std::size_t count) const override;

private:
  /// A sample of the light (First) or of the lobe (Second). @param light,lobe shares s_i of both
  DirectionSample combined(const Vec3& direction, Technique technique, float light,
                           float lobe) const;

  LightSampler m_light;
  Heuristic m_heuristic;
  Lobe m_lobe;
  std::vector<Vec2> m_points;
  std::vector<float> m_light_pdfs;
};

} // namespace haarlight::renderer
