#pragma once
// What both variants of bidirectional importance sampling share (Burke, Ghosh and Heidrich 2005).

#include "bidirectional_proposal.h"
#include "candidate_pool.h"

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
    const std::size_t round = std::max<std::size_t>(1, pool_capacity / m_per_sample);
    for (std::size_t i = 0; i < out.size(); i += round) {
      m_pool.clear();
      sample_round({points.kind, points.key, points.first + static_cast<std::uint32_t>(i)},
                   out.subspan(i, std::min(round, out.size() - i)));
    }
  }

  float pdf(const Vec3& direction, std::size_t /*count*/) const override {
    return m_proposal.pdf(direction);
  }

protected:
  /// Fills `out` from a pool that is empty.
  virtual void sample_round(const PointSource& points, std::span<DirectionSample> out) = 0;

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
      out[i] = sum > 0 ? m_pool.chosen(m_pool.choose(0, m_pool.size(), place), mean_weight())
                       : DirectionSample{Vec3::UnitZ(), 0};
    }
  }

  double mean_weight() const {
    return m_pool.sum(0, m_pool.size()) / static_cast<double>(m_pool.size());
  }

  std::size_t candidates_of(std::size_t count) const { return m_per_sample * count; }
  float bound() const { return m_proposal.bound(); }
  const CandidatePool& pool() const { return m_pool; }

private:
  const Light& m_light;
  BidirectionalProposal m_proposal;
  std::size_t m_per_sample;
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  CandidatePool m_pool;
  std::vector<Vec2> m_numbers;
};

} // namespace haarlight::renderer
