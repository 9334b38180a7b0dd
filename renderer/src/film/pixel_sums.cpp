#include "film/pixel_sums.h"

#include <algorithm>
#include <array>
#include <vector>

namespace haarlight::renderer {

void PixelSums::add(const Rgb& weight, bool v, float p) {
  unshadowed += weight;
  if (v)
    shadowed += weight;
  pdf += static_cast<double>(p);
  ++count;
}

void PixelSums::add_direction(bool v) {
  ++directions;
  visible += v ? 1 : 0;
}

void PixelSums::add_variance(const SumVariance& of_pass, std::uint32_t samples) {
  if (samples < 2)
    return;
  variance += of_pass;
  variance_count += samples;
}

namespace {

/// Of the paper's eq. 9: of the directions above the horizon; 1 if there are none, as in the ratio
/// estimator if no sample has a weight.
float visible_fraction(const PixelSums& sums) {
  return sums.directions > 0
             ? static_cast<float>(sums.visible) / static_cast<float>(sums.directions)
             : 1.0F;
}

Rgb estimate_reflected(const PixelSums& sums, Estimator estimator) {
  if (sums.count == 0)
    return Rgb::Zero();
  const auto n = static_cast<float>(sums.count);
  switch (estimator) {
  case Estimator::Unbiased:
    return sums.shadowed / n;
  case Estimator::Bidirectional:
    return sums.product * visible_fraction(sums);
  case Estimator::Ratio:
    return sums.product * (sums.unshadowed > 0).select(sums.shadowed / sums.unshadowed, 1.0F);
  }
  return Rgb::Zero();
}

/// Sums over one technique's samples (luminance), which are independent and identically distributed
/// if points are random.
struct TechniqueSums {
  std::uint32_t count = 0;
  double shadowed = 0;        ///< Σ w v
  double unshadowed = 0;      ///< Σ w
  double shadowed_square = 0; ///< Σ w² v
  double square = 0;          ///< Σ w²

  void add(const Contribution& sample) {
    const double w = sample.luminance;
    ++count;
    unshadowed += w;
    square += w * w;
    if (sample.visible) {
      shadowed += w;
      shadowed_square += w * w;
    }
  }

  /// Of the sums, n times that of a sample; needs two samples.
  SumVariance variance() const {
    const double n = count;
    const double scale = n / (n - 1);
    return {scale * (shadowed_square - shadowed * shadowed / n),
            scale * (shadowed_square - shadowed * unshadowed / n),
            scale * (square - unshadowed * unshadowed / n)};
  }
};

using Techniques = std::array<TechniqueSums, random_techniques>;

/// A sample for estimates from pairs.
struct PairSample {
  double luminance = 0;                            ///< w
  double visible = 0;                              ///< v
  double balance_value = 0;                        ///< f / (mean density), luminance
  std::array<double, random_techniques> balance;   ///< weights b_t of the balance heuristic
  std::array<double, random_techniques> heuristic; ///< weights w_t of the sampler's heuristic
};

PairSample pair_sample(const Contribution& c) {
  PairSample s;
  s.luminance = c.luminance;
  s.visible = c.visible ? 1 : 0;
  s.balance = {static_cast<double>(c.first.balance), 1 - static_cast<double>(c.first.balance)};
  s.heuristic = {static_cast<double>(c.first.heuristic),
                 1 - static_cast<double>(c.first.heuristic)};
  const auto t = static_cast<std::size_t>(c.technique);
  s.balance_value = s.heuristic[t] > 0 ? c.luminance * s.balance[t] / s.heuristic[t] : 0;
  return s;
}

/// The estimate from pairs of samples, for techniques with a single sample.
///
/// n_t samples of technique t, of density p_t, have the variance Σ w² − Σ_t n_t m_t² in
/// expectation, m_t being the mean of w over p_t. The latter sum is an integral over pairs of
/// directions, of which every ordered pair of different samples is a sample: with N p̄ = Σ_t n_t
/// p_t and the balance heuristic's weights b_t = n_t p_t / (N p̄) their density is N² p̄(x) p̄(y) (1 −
/// c), c = Σ_t b_t(x) b_t(y) / n_t, and the integrand is N² f(x) f(y) Σ_t w_t(x) w_t(y) / n_t.
SumVariance variance_from_pairs(std::span<const Contribution> samples,
                                const Techniques& techniques) {
  std::vector<PairSample> pairs;
  SumVariance sum;
  for (const Contribution& c : samples) {
    if (c.technique == Technique::Fixed)
      continue;
    const PairSample& s = pairs.emplace_back(pair_sample(c));
    const double square = s.luminance * s.luminance;
    sum += {s.visible * square, s.visible * square, square};
  }
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const PairSample& x = pairs[i];
      const PairSample& y = pairs[j];
      double balance = 0;
      double heuristic = 0;
      for (std::size_t t = 0; t < random_techniques; ++t)
        if (techniques[t].count > 0) {
          const double n = techniques[t].count;
          balance += x.balance[t] * y.balance[t] / n;
          heuristic += x.heuristic[t] * y.heuristic[t] / n;
        }
      if (!(balance < 1)) // a pair of density 0, but for rounding
        continue;
      const double product = 2 * x.balance_value * y.balance_value * heuristic / (1 - balance);
      sum.shadowed -= x.visible * y.visible * product;
      sum.covariance -= 0.5 * (x.visible + y.visible) * product;
      sum.unshadowed -= product;
    }
  return sum;
}

} // namespace

SumVariance variance_of_sums(std::span<const Contribution> samples) {
  Techniques techniques;
  for (const Contribution& sample : samples)
    if (sample.technique != Technique::Fixed)
      techniques[static_cast<std::size_t>(sample.technique)].add(sample);
  if (std::ranges::any_of(techniques, [](const auto& t) { return t.count == 1; }))
    return variance_from_pairs(samples, techniques);
  SumVariance sum;
  for (const TechniqueSums& t : techniques)
    if (t.count > 1)
      sum += t.variance();
  return sum;
}

Rgb estimate(const PixelSums& sums, Estimator estimator) {
  return sums.emitted + estimate_reflected(sums, estimator);
}

double estimate_variance(const PixelSums& sums, Estimator estimator) {
  const auto product = static_cast<double>(luminance(sums.product));
  if (estimator == Estimator::Bidirectional) {
    const auto fraction = static_cast<double>(visible_fraction(sums));
    return product * product * fraction * (1 - fraction) / std::max(1.0, sums.directions - 1.0);
  }
  if (sums.variance_count == 0)
    return 0;
  const double n = sums.count;
  SumVariance variance = sums.variance;
  variance *= n / sums.variance_count;
  if (estimator == Estimator::Unbiased)
    return variance.shadowed / (n * n);
  const auto whole = static_cast<double>(luminance(sums.unshadowed));
  if (!(whole > 0))
    return 0;
  // By the delta method, from the residuals w v − ratio·w.
  const double ratio = static_cast<double>(luminance(sums.shadowed)) / whole;
  const double residual =
      variance.shadowed - 2 * ratio * variance.covariance + ratio * ratio * variance.unshadowed;
  return residual * product * product / (whole * whole);
}

} // namespace haarlight::renderer
