#pragma once
// What both variants of bidirectional importance sampling share (Burke, Ghosh and Heidrich 2005).

#include "samplers/bidirectional_proposal.h"
#include "samplers/candidate_pool.h"

#include <algorithm>

namespace haarlight::renderer {

/// Samples follow p = f_r L cos / L_ns, of luminance, and count with that p, L_ns being the mean
/// weight of the candidates. A variant chooses the samples of a round.
class BidirectionalSampler : public Sampler {
public:
  /// @param candidates for each sample
  BidirectionalSampler(const std::shared_ptr<const ProposalBounds>& bounds, int candidates)
      : m_light(bounds->light()), m_proposal(bounds),
        m_per_sample(static_cast<std::size_t>(std::max(1, candidates))) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_point = &point;
    m_material = &material;
    m_proposal.prepare(point, material);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    const std::size_t most = std::max<std::size_t>(1, pool_capacity / m_per_sample);
    m_rounds.clear();
    m_weights.clear();
    for (std::size_t i = 0; i < out.size(); i += most) {
      m_pool.clear();
      const std::size_t count = std::min(most, out.size() - i);
      const std::size_t accepted =
          sample_round({points.kind, points.key, points.first + static_cast<std::uint32_t>(i)},
                       out.subspan(i, count));
      m_rounds.push_back({count, accepted, m_pool.size(), mean_weight(), m_pool.mean_square()});
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_proposal.pdf(direction);
  }

  SumVariance shared_variance(std::span<const std::uint8_t> visible) const override {
    SumVariance sum;
    std::size_t first = 0;
    std::size_t first_weight = 0;
    for (const Round& round : m_rounds) {
      const std::size_t chosen = round.mean > 0 ? round.count : 0;
      const SumVariance one =
          round_variance(round, std::span(m_weights).subspan(first_weight, chosen),
                         visible.subspan(first, round.count));
      sum.shadowed += one.shadowed;
      sum.covariance += one.covariance;
      sum.unshadowed += one.unshadowed;
      first += round.count;
      first_weight += chosen;
    }
    return sum;
  }

protected:
  /// Fills `out` from a pool that is empty, by take().
  /// @return how many of the first were accepted; the others are resampled
  virtual std::size_t sample_round(const PointSource& points, std::span<DirectionSample> out) = 0;

  /// The next sample of the round.
  DirectionSample take(std::size_t candidate) {
    m_weights.push_back(m_pool.weight(candidate));
    return m_pool.chosen(candidate, mean_weight());
  }

  /// Draws and weighs so many more candidates.
  void draw(const PointSource& points, std::size_t count, float bound) {
    const auto first = static_cast<std::uint32_t>(points.first * m_per_sample + m_pool.size());
    m_proposal.sample({points.kind, points.key, first}, m_pool.extend(count));
    m_pool.weigh(m_light, *m_point, *m_material, bound);
  }

  /// Chooses among the candidates at hand in proportion to their weights, with replacement.
  void resample(const PointSource& points, std::span<DirectionSample> out) {
    const double sum = m_pool.sum(0, m_pool.size());
    m_numbers.resize(out.size());
    points.fill(3, m_numbers);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double place = static_cast<double>(m_numbers[i].x()) * sum;
      const std::size_t candidate = sum > 0 ? m_pool.choose(0, m_pool.size(), place) : 0;
      out[i] = sum > 0 ? take(candidate) : DirectionSample{Vec3::UnitZ(), 0};
    }
  }

  double mean_weight() const {
    return m_pool.sum(0, m_pool.size()) / static_cast<double>(m_pool.size());
  }

  std::size_t candidates_of(std::size_t count) const { return m_per_sample * count; }
  float bound() const { return m_proposal.bound(); }
  const CandidatePool& pool() const { return m_pool; }

private:
  /// A pool that samples were chosen from.
  struct Round {
    std::size_t count = 0;    ///< samples
    std::size_t accepted = 0; ///< of those
    std::size_t candidates = 0;
    double mean = 0;   ///< of the candidates' weights
    double square = 0; ///< mean of the weights' squares
  };

  /// The variance that the candidates leave in a round's Σ w v and Σ w, given that the variance of
  /// v among its n samples is counted as that of n independent ones.
  ///
  /// With weights W of m candidates of mean μ the round's sums are n μ (mean of v) and n μ. Samples
  /// are chosen in proportion to W, so that mean(W² v) is μ times the mean of W v over the samples;
  /// q = mean(W v) / μ is the mean of v. Given the candidates, means are exact for the choice, and
  /// vary by Var(W v) / m over the candidates. Accepted samples are drawn without replacement: of n
  /// that are, the choice has mean(W² (v − q)²) / m less than n independent ones.
  static SumVariance round_variance(const Round& r, std::span<const float> weights,
                                    std::span<const std::uint8_t> visible) {
    if (r.candidates < 2 || weights.empty())
      return {};
    const auto n = static_cast<double>(r.count);
    double q = 0;
    double weighted = 0;
    for (std::size_t i = 0; i < r.count; ++i)
      if (visible[i] != 0) {
        q += 1 / n;
        weighted += static_cast<double>(weights[i]) / n;
      }
    const double q_square = r.count > 1 ? q * q - q * (1 - q) / (n - 1) : q * q;
    const double square_visible = r.mean * weighted; // mean(W² v)
    const double mean_square = r.mean * r.mean;
    const double accepted = static_cast<double>(r.accepted) / n;
    const double without_replacement =
        accepted * accepted * (square_visible * (1 - 2 * q) + q_square * r.square);
    const double scale = n * n / (static_cast<double>(r.candidates) - 1);
    return {scale * (square_visible - mean_square * q_square - without_replacement),
            scale * (square_visible - mean_square * q), scale * (r.square - mean_square)};
  }

  const Light& m_light;
  BidirectionalProposal m_proposal;
  std::size_t m_per_sample;
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  CandidatePool m_pool;
  std::vector<Round> m_rounds;  ///< of the last sample()
  std::vector<float> m_weights; ///< of its samples, as candidates
  std::vector<Vec2> m_numbers;
};

} // namespace haarlight::renderer
