// Samplers that draw candidates from a simple density q, weight them by f_r L cos / q (luminance)
// and choose some of them:
// - `bis-reject`, `bis-sir`: bidirectional importance sampling by rejection and by
//   sampling-importance resampling (Burke, Ghosh and Heidrich 2005);
// - `ris`: resampled importance sampling (Talbot, Cline and Egbert 2005).

#include "samplers/basic_samplers.h"
#include "samplers/sampler_factories.h"

#include <wavelet/base/parallel.h>
#include <wavelet/base/trigonometry.h>

#include <algorithm>
#include <limits>

namespace haarlight::renderer {
namespace {

/// Candidates and random numbers in memory at once, at most.
constexpr std::size_t pool_capacity = 65536;

class CandidatePool {
public:
  void clear() {
    m_samples.clear();
    m_weights.clear();
    m_sums.resize(1);
  }

  /// Adds candidates, to be filled with directions and the densities q they are drawn with.
  std::span<DirectionSample> extend(std::size_t count) {
    const std::size_t first = m_samples.size();
    m_samples.resize(first + count);
    return std::span(m_samples).subspan(first);
  }

  /// Computes the weights of the last extend(): lum(f_r L cos) / q, at most `bound`.
  void compute_weights(const Light& light, const ShadingPoint& point, const Material& material,
                       float bound = std::numeric_limits<float>::max()) {
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

  std::size_t size() const { return m_samples.size(); }
  float weight(std::size_t i) const { return m_weights[i]; }

  /// Sum of the weights of candidates begin … end − 1.
  double sum(std::size_t begin, std::size_t end) const { return m_sums[end] - m_sums[begin]; }

  double mean_weight() const { return sum(0, size()) / static_cast<double>(size()); }

  /// Mean of the squares of all weights.
  double mean_square() const {
    double sum = 0;
    for (const float weight : m_weights)
      sum += static_cast<double>(weight) * static_cast<double>(weight);
    return m_weights.empty() ? 0 : sum / static_cast<double>(m_weights.size());
  }

  /// The candidate of begin … end − 1 in whose part of the cumulative weights `place` lies.
  /// @param place in [0, sum(begin, end))
  std::size_t choose(std::size_t begin, std::size_t end, double place) const {
    const auto sums = m_sums.begin();
    const auto from = sums + static_cast<std::ptrdiff_t>(begin) + 1;
    const auto to = sums + static_cast<std::ptrdiff_t>(end);
    return static_cast<std::size_t>(std::upper_bound(from, to, m_sums[begin] + place) - sums) - 1;
  }

  /// A chosen candidate with the density it counts with: f_r L cos / pdf has the luminance
  /// `mean_weight`, or more where the bound cut its weight.
  DirectionSample chosen(std::size_t i, double mean_weight) const {
    const DirectionSample& s = m_samples[i];
    return {s.direction, static_cast<float>(static_cast<double>(m_weights[i]) *
                                            static_cast<double>(s.pdf) / mean_weight)};
  }

private:
  std::vector<DirectionSample> m_samples;
  std::vector<float> m_weights;
  std::vector<double> m_sums = {0};
  std::vector<Vec3> m_directions;
  std::vector<Rgb> m_reflectance;
  std::vector<Rgb> m_radiance;
};

/// f_r cos at one θ_r, luminance.
struct LobePeak {
  float value = 0;  ///< largest value found, sr⁻¹
  float albedo = 0; ///< ∫ f_r cos dω
};

LobePeak find_peak(const ShadingPoint& point, const Material& material) {
  constexpr std::size_t directions_tried = 1024;
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

/// Properties of light and reflectances from which the proposal is chosen; shared by threads.
/// Peaks are found by sampling: they are near the true maxima, but not strict bounds.
class ProposalBounds {
public:
  explicit ProposalBounds(const LoadedScene& scene)
      : m_light(scene.light()), m_materials(scene.materials()),
        m_peaks(m_materials.size() * theta_cells) {
    parallel_for(m_peaks.size(), [&](std::size_t i) {
      const float theta_r =
          (static_cast<float>(i % theta_cells) + 0.5F) * (0.5F * pi / theta_cells);
      float s = 0;
      float c = 1;
      sine_cosine(theta_r, s, c);
      m_peaks[i] =
          find_peak(shading_point(Vec3::UnitZ(), Vec3(s, 0, c)), m_materials[i / theta_cells]);
    });
    constexpr std::size_t count = 16384;
    std::vector<Vec2> points(count);
    fill_points(Points::Sobol, 0, 0, points);
    std::vector<probe::LightSample> samples(count);
    m_light.sample(points, samples);
    for (const probe::LightSample& s : samples) {
      const float value = luminance(m_light.radiance(s.direction));
      m_power += s.pdf > 0 ? value / s.pdf / static_cast<float>(count) : 0.0F;
      m_max_radiance = std::max(m_max_radiance, value);
    }
  }

  /// Of the θ_r cell of a point.
  const LobePeak& peak(const ShadingPoint& point, const Material& material) const {
    const float theta_r = arctangent(point.reflection.sin_theta_r, point.reflection.cos_theta_r);
    const int cell =
        std::clamp(static_cast<int>(theta_r * (2.0F * theta_cells / pi)), 0, theta_cells - 1);
    const auto index = static_cast<std::size_t>(&material - m_materials.data());
    return m_peaks[index * theta_cells + static_cast<std::size_t>(cell)];
  }

  const Light& light() const { return m_light; }
  float power() const { return m_power; }               ///< ∫ lum L dω
  float max_radiance() const { return m_max_radiance; } ///< largest lum L

private:
  static constexpr int theta_cells = 64; ///< of θ_r per material

  const Light& m_light;
  const std::vector<Material>& m_materials;
  std::vector<LobePeak> m_peaks;
  float m_power = 0;
  float m_max_radiance = 0;
};

/// Of q ∝ L and q ∝ f_r cos the one whose largest weight f_r L cos / q is smaller at a point, so
/// that more candidates are accepted.
class BidirectionalProposal {
public:
  explicit BidirectionalProposal(std::shared_ptr<const ProposalBounds> bounds)
      : m_bounds(std::move(bounds)), m_light(m_bounds->light()) {}

  void prepare(const ShadingPoint& point, const Material& material) {
    const LobePeak& peak = m_bounds->peak(point, material);
    const float light_bound = m_bounds->power() * peak.value;
    const float lobe_bound = m_bounds->max_radiance() * peak.albedo;
    m_from_light = light_bound <= lobe_bound;
    m_bound = std::min(light_bound, lobe_bound);
    m_lobe.prepare(point, material);
  }

  /// Draws candidates with their densities.
  void sample(const PointSource& points, std::span<DirectionSample> out) {
    if (m_from_light)
      return m_light.sample(points, out);
    m_points.resize(out.size());
    points.fill(1, m_points);
    m_lobe.sample(m_points, out);
  }

  float pdf(const Vec3& direction) const {
    return m_from_light ? m_light.pdf(direction) : m_lobe.pdf(direction);
  }

  const Light& light() const { return m_bounds->light(); }

  /// Weights exceed this only rarely.
  float bound() const { return m_bound; }

private:
  std::shared_ptr<const ProposalBounds> m_bounds;
  LightSampler m_light;
  Lobe m_lobe;
  bool m_from_light = true;
  float m_bound = 0;
  std::vector<Vec2> m_points;
};

enum class Selection {
  Rejection, ///< accepts candidates with probability weight / bound until there are enough samples,
             ///< or after M tries per sample; missing samples are resampled from the candidates
  Resampling ///< chooses N of M N candidates
};

/// Samples follow p = f_r L cos / L_ns (luminance) and count with that p, where L_ns is estimated
/// by the mean weight of the candidates.
class BidirectionalSampler : public Sampler {
public:
  /// @param candidates per sample
  BidirectionalSampler(const std::shared_ptr<const ProposalBounds>& bounds, Selection selection,
                       int candidates)
      : m_selection(selection), m_proposal(bounds),
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
      const PointSource round = {points.kind, points.key,
                                 points.first + static_cast<std::uint32_t>(i)};
      const std::span<DirectionSample> samples = out.subspan(i, count);
      std::size_t accepted = 0;
      if (m_selection == Selection::Rejection)
        accepted = accept(round, samples);
      else
        draw(round, m_per_sample * count, std::numeric_limits<float>::max());
      resample(round, samples.subspan(accepted));
      m_rounds.push_back(
          {count, accepted, m_pool.size(), m_pool.mean_weight(), m_pool.mean_square()});
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

private:
  /// Samples chosen from one pool.
  struct Round {
    std::size_t count = 0;    ///< samples
    std::size_t accepted = 0; ///< of those, by rejection
    std::size_t candidates = 0;
    double mean = 0;   ///< of the candidates' weights
    double square = 0; ///< mean of the weights' squares
  };

  /// Draws further candidates and computes their weights.
  void draw(const PointSource& points, std::size_t count, float bound) {
    const auto first = static_cast<std::uint32_t>(points.first * m_per_sample + m_pool.size());
    m_proposal.sample({points.kind, points.key, first}, m_pool.extend(count));
    m_pool.compute_weights(m_proposal.light(), *m_point, *m_material, bound);
  }

  /// Fills the first samples by rejection. @return their number
  std::size_t accept(const PointSource& points, std::span<DirectionSample> out) {
    constexpr std::size_t batch = 64;
    const std::size_t most = m_per_sample * out.size();
    m_accepted.clear();
    while (m_accepted.size() < out.size() && m_pool.size() < most) {
      const std::size_t first = m_pool.size();
      const std::size_t count = std::min(batch, most - first);
      m_numbers.resize(count);
      const auto index = static_cast<std::uint32_t>(m_per_sample * points.first + first);
      PointSource{points.kind, points.key, index}.fill(4, m_numbers);
      draw(points, count, m_proposal.bound());
      for (std::size_t i = 0; i < count && m_accepted.size() < out.size(); ++i)
        if (m_numbers[i].x() * m_proposal.bound() < m_pool.weight(first + i))
          m_accepted.push_back(first + i);
    }
    for (std::size_t i = 0; i < m_accepted.size(); ++i)
      out[i] = take(m_accepted[i]);
    return m_accepted.size();
  }

  /// Chooses among all candidates in proportion to their weights, with replacement.
  void resample(const PointSource& points, std::span<DirectionSample> out) {
    const double sum = m_pool.sum(0, m_pool.size());
    m_numbers.resize(out.size());
    points.fill(3, m_numbers);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double place = static_cast<double>(m_numbers[i].x()) * sum;
      out[i] = sum > 0 ? take(m_pool.choose(0, m_pool.size(), place))
                       : DirectionSample{Vec3::UnitZ(), 0};
    }
  }

  /// The next sample of the round.
  DirectionSample take(std::size_t candidate) {
    m_weights.push_back(m_pool.weight(candidate));
    return m_pool.chosen(candidate, m_pool.mean_weight());
  }

  /// The variance that the candidates add to a round's Σ w v and Σ w, given that the variance of v
  /// among its n samples is counted as that of n independent ones.
  ///
  /// With weights W of m candidates of mean μ the round's sums are n μ (mean of v) and n μ. Samples
  /// are chosen in proportion to W, so that mean(W² v) is μ times the mean of W v over the samples;
  /// q = mean(W v) / μ is the mean of v. Given the candidates, means are exact for the choice, and
  /// vary by Var(W v) / m over the candidates. Accepted samples are drawn without replacement: if
  /// all n are accepted, the choice has mean(W² (v − q)²) / m less than n independent ones.
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

  Selection m_selection;
  BidirectionalProposal m_proposal;
  std::size_t m_per_sample;
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  CandidatePool m_pool;
  std::vector<Round> m_rounds;  ///< of the last sample()
  std::vector<float> m_weights; ///< of its samples, as candidates
  std::vector<std::size_t> m_accepted;
  std::vector<Vec2> m_numbers;
};

/// Of M candidates for each sample, half from the light and half from the reflectance, one is
/// chosen in proportion to f_r L cos over their mean density, and counts with its target over the
/// mean weight of its own M.
class RisSampler : public Sampler {
public:
  RisSampler(const Light& light, int candidates)
      : m_light(light), m_proposal(light, Heuristic::Balance),
        m_pairs(static_cast<std::size_t>(std::max(1, candidates / 2))) {}

  void prepare(const ShadingPoint& point, const Material& material) override {
    m_point = &point;
    m_material = &material;
    m_proposal.prepare(point, material);
  }

  void sample(const PointSource& points, std::span<DirectionSample> out) override {
    m_numbers.resize(out.size());
    points.fill(3, m_numbers);
    const std::size_t round = std::max<std::size_t>(1, round_candidates / (2 * m_pairs));
    for (std::size_t i = 0; i < out.size(); i += round) {
      const std::size_t count = std::min(round, out.size() - i);
      const auto first = points.first + static_cast<std::uint32_t>(i);
      m_pool.clear();
      m_proposal.sample({points.kind, points.key, first * static_cast<std::uint32_t>(m_pairs)},
                        m_pool.extend(2 * m_pairs * count));
      m_pool.compute_weights(m_light, *m_point, *m_material);
      for (std::size_t k = 0; k < count; ++k)
        out[i + k] = choose(k, count, m_numbers[i + k].x());
    }
  }

  float pdf(const Vec3& direction, std::size_t count) const override {
    return m_proposal.pdf(direction, 2 * m_pairs * count);
  }

private:
  static constexpr std::size_t round_candidates = 4096; ///< that stay in the cache

  /// From the k-th part of the light's candidates and the k-th part of the reflectance's.
  DirectionSample choose(std::size_t k, std::size_t count, float u) const {
    const std::size_t light = k * m_pairs;
    const std::size_t lobe = (count + k) * m_pairs;
    const double light_sum = m_pool.sum(light, light + m_pairs);
    const double sum = light_sum + m_pool.sum(lobe, lobe + m_pairs);
    if (!(sum > 0))
      return {Vec3::UnitZ(), 0};
    const double place = static_cast<double>(u) * sum;
    const std::size_t i = place < light_sum
                              ? m_pool.choose(light, light + m_pairs, place)
                              : m_pool.choose(lobe, lobe + m_pairs, place - light_sum);
    return m_pool.chosen(i, sum / static_cast<double>(2 * m_pairs));
  }

  const Light& m_light;
  MisSampler m_proposal;
  std::size_t m_pairs; ///< of candidates for each sample, one from the light, one from the lobe
  const ShadingPoint* m_point = nullptr;
  const Material* m_material = nullptr;
  CandidatePool m_pool;
  std::vector<Vec2> m_numbers;
};

} // namespace

std::unique_ptr<SamplerFactory> make_bis_reject_factory(const LoadedScene& scene,
                                                        const SamplerOptions& options) {
  return simple_factory<BidirectionalSampler>(std::make_shared<const ProposalBounds>(scene),
                                              Selection::Rejection, options.candidates);
}

std::unique_ptr<SamplerFactory> make_bis_sir_factory(const LoadedScene& scene,
                                                     const SamplerOptions& options) {
  return simple_factory<BidirectionalSampler>(std::make_shared<const ProposalBounds>(scene),
                                              Selection::Resampling, options.candidates);
}

std::unique_ptr<SamplerFactory> make_ris_factory(const LoadedScene& scene,
                                                 const SamplerOptions& options) {
  return simple_factory<RisSampler>(std::cref(scene.light()), options.candidates);
}

} // namespace haarlight::renderer
