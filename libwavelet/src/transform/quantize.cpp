#include <wavelet/transform/quantize.h>

#include "transform/coefficient_walk.h"

#include <bit>
#include <cmath>
#include <vector>

namespace haarlight::wavelet {
namespace {

/// Found by trying on seven measured BRDFs: the packed size at equal error is flat around both.
constexpr double dead_zone = 0.65;
constexpr float chroma_step = 2;

struct Triple {
  float* difference;
  int level;
};

/// A step of few binary digits, so that its products with integers are exact floats.
float step_of(int index) { return std::ldexp(static_cast<float>(128 + (index & 127)), index >> 7); }

Rgb rounded(const Rgb& c, float step) {
  const Rgb u = c / step;
  if (weighted_square(u.data()) <= dead_zone * dead_zone)
    return Rgb::Zero();
  const float green = std::nearbyint(u[1]);
  const auto chroma = [&](float value) {
    return green + chroma_step * std::nearbyint((value - green) / chroma_step);
  };
  return step * Rgb(chroma(u[0]), green, chroma(u[2]));
}

/// Rounds all triples of a map with one step.
class UniformRounding {
public:
  explicit UniformRounding(Map& map) {
    const auto visit = [&](float* c, int level, double) {
      const double square = std::ldexp(weighted_square(c), -2 * level);
      if (square > 0)
        m_triples.push_back({c, level});
      m_energy += square;
    };
    CoefficientWalk(map, visit).run();
    m_energy += weighted_square(map.rgb.data());
  }

  double energy() const { return m_energy; }

  double squared_error(float step) const {
    double sum = 0;
    for (const Triple& t : m_triples) {
      const Rgb c = Eigen::Map<const Rgb>(t.difference);
      const Rgb error = c - rounded(c, std::ldexp(step, t.level));
      sum += std::ldexp(weighted_square(error.data()), -2 * t.level);
    }
    return sum;
  }

  std::size_t apply(float step) const {
    std::size_t kept = 0;
    for (const Triple& t : m_triples) {
      Eigen::Map<Rgb> c(t.difference);
      c = rounded(c, std::ldexp(step, t.level));
      kept += c.isZero(0) ? 0 : 1;
    }
    return kept;
  }

private:
  std::vector<Triple> m_triples;
  double m_energy = 0;
};

/// The largest step within the tolerance, by bisection; the error hardly ever falls as the step
/// grows.
Quantized round_to_tolerance(Map& transformed, double tolerance) {
  const UniformRounding rounding(transformed);
  const double budget = tolerance * tolerance * rounding.energy();
  const int scale_exponent = static_cast<int>(std::ceil(std::log2(std::sqrt(rounding.energy()))));
  int high = 128 * (scale_exponent + 2 - 7);
  int low = high - 128 * 32;
  if (!(budget > 0) || rounding.squared_error(step_of(low)) > budget)
    return {apply_threshold(transformed, {Criterion::L2, tolerance, std::nullopt}).coefficients, 0};
  while (high - low > 1) {
    const int middle = low + (high - low) / 2;
    (rounding.squared_error(step_of(middle)) <= budget ? low : high) = middle;
  }
  const int levels = std::countr_zero(static_cast<unsigned>(transformed.size));
  return {rounding.apply(step_of(low)), std::ldexp(step_of(low), levels - 1)};
}

/// The power of two at or below a positive number.
float power_below(double value) {
  int exponent = 0;
  std::frexp(value, &exponent);
  return static_cast<float>(std::ldexp(1.0, exponent - 1));
}

std::size_t round_to_limit(Map& transformed, Criterion criterion, double limit) {
  const double mean = luminance(transformed.at(0, 0));
  std::size_t kept = 0;
  const auto visit = [&](float* c, int level, double average) {
    const float step = power_below(2 * limit / rank_factor(level, average, mean, criterion));
    Eigen::Map<Rgb> colour(c);
    for (float& value : colour)
      value = step * std::nearbyint(value / step);
    kept += colour.isZero(0) ? 0 : 1;
  };
  CoefficientWalk(transformed, visit).run();
  return kept;
}

} // namespace

Quantized apply_quantization(Map& transformed, const ThresholdOptions& options) {
  if (options.criterion == Criterion::L2 && !options.keep)
    return round_to_tolerance(transformed, options.tolerance);
  const Kept kept = apply_threshold(transformed, options);
  if (kept.limit <= 0)
    return {kept.coefficients, 0};
  return {round_to_limit(transformed, options.criterion, kept.limit), 0};
}

} // namespace haarlight::wavelet
