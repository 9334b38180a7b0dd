#include "samplers/candidate_pool.h"

#include <algorithm>

namespace haarlight::renderer {

void CandidatePool::clear() {
  m_samples.clear();
  m_weights.clear();
  m_sums.resize(1);
}

std::span<DirectionSample> CandidatePool::extend(std::size_t count) {
  const std::size_t first = m_samples.size();
  m_samples.resize(first + count);
  return std::span(m_samples).subspan(first);
}

void CandidatePool::weigh(const Light& light, const ShadingPoint& point, const Material& material,
                          float bound) {
  const std::size_t first = m_weights.size();
  const std::size_t count = m_samples.size() - first;
  m_directions.resize(count);
  m_reflectance.resize(count);
  m_radiance.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    m_directions[i] = m_samples[first + i].direction;
  material.evaluate(point, m_directions, m_reflectance);
  light.radiance(m_directions, m_radiance);
  for (std::size_t i = 0; i < count; ++i) {
    const float q = m_samples[first + i].pdf;
    const float target = luminance(m_reflectance[i] * m_radiance[i]);
    m_weights.push_back(q > 0 ? std::min(target / q, bound) : 0.0F);
    m_sums.push_back(m_sums.back() + static_cast<double>(m_weights.back()));
  }
}

double CandidatePool::mean_square() const {
  double sum = 0;
  for (const float weight : m_weights)
    sum += static_cast<double>(weight) * static_cast<double>(weight);
  return m_weights.empty() ? 0 : sum / static_cast<double>(m_weights.size());
}

std::size_t CandidatePool::choose(std::size_t begin, std::size_t end, double place) const {
  const auto sums = m_sums.begin();
  const auto from = sums + static_cast<std::ptrdiff_t>(begin) + 1;
  const auto to = sums + static_cast<std::ptrdiff_t>(end);
  const auto above = std::upper_bound(from, to, m_sums[begin] + place);
  return static_cast<std::size_t>(above - sums) - 1;
}

DirectionSample CandidatePool::chosen(std::size_t i, double mean_weight) const {
  const DirectionSample& s = m_samples[i];
  return {s.direction, static_cast<float>(static_cast<double>(m_weights[i]) *
                                          static_cast<double>(s.pdf) / mean_weight)};
}

} // namespace haarlight::renderer
