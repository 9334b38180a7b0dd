#pragma once
// Candidates of the samplers that resample: directions drawn from something simple, weighed by what
// they reflect, of which a few are chosen.

#include <renderer/samplers/sampler.h>

#include <limits>
#include <span>
#include <vector>

namespace haarlight::renderer {

/// A run of candidates and of the numbers that choose from them at most takes so many at a time, so
/// that memory stays bounded.
inline constexpr std::size_t pool_capacity = 65536;

class CandidatePool {
public:
  /// Forgets all candidates.
  void clear();

  /// Makes room for more, to be filled with directions and the densities q they are drawn with.
  std::span<DirectionSample> extend(std::size_t count);

  /// Weighs what extend() added last: weight = lum(f_r L cos) / q, but no more than `bound`.
  void weigh(const Light& light, const ShadingPoint& point, const Material& material,
             float bound = std::numeric_limits<float>::max());

  std::size_t size() const { return m_samples.size(); }
  float weight(std::size_t i) const { return m_weights[i]; }

  /// Sum of the weights of candidates begin … end − 1.
  double sum(std::size_t begin, std::size_t end) const { return m_sums[end] - m_sums[begin]; }

  /// Mean of the squares of all weights.
  double mean_square() const;

  /// The candidate that a place in [0, sum(begin, end)) falls on, in proportion to weight.
  std::size_t choose(std::size_t begin, std::size_t end, double place) const;

  /// A candidate as it counts once chosen: f_r L cos / pdf has the luminance `mean_weight`, or more
  /// where the bound cut its weight.
  DirectionSample chosen(std::size_t i, double mean_weight) const;

private:
  std::vector<DirectionSample> m_samples;
  std::vector<float> m_weights;
  std::vector<double> m_sums = {0};
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_reflectance;
  std::vector<Rgb> m_radiance;
};

} // namespace haarlight::renderer
