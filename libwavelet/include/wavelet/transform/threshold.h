#pragma once
// Which coefficients of a transformed map to keep, and their rounding for packed files.

#include <wavelet/tree/map_set.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace haarlight::wavelet {

/// How a coefficient c (of the L2-normalised wavelet on square s at level l) is ranked. Colours
/// count by c² = Σ w_i c_i², w the luminance weights.
enum class Criterion {
  Variance, ///< |c| / sqrt(A·Ā), A = F(s) ≥ 3 % of the mean Ā: its share in a sampler's variance.
            ///< Tolerance: the largest rank dropped
  L2, ///< |c|. Tolerance: bound of the relative L2 error ‖F − F'‖/‖F‖, reached as nearly as
      ///< possible
  Linf, ///< |c|·2^l. Tolerance: bound of the error's maximum relative to max |F|
  Count ///< |c|, keeping a given number
};

std::string criterion_name(Criterion criterion);

/// Σ w c² of an RGB triple, w the luminance weights: the norm that coefficients and errors are
/// measured by.
inline double weighted_square(const float* c) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    sum += static_cast<double>(luminance_weights[i]) * c[i] * c[i];
  return sum;
}

struct ThresholdOptions {
  Criterion criterion = Criterion::Variance;
  double tolerance = 0.0005; ///< see Criterion; 0 keeps everything that is not zero
  std::optional<std::size_t>
      keep; ///< if given, the number of highest-ranked coefficients to keep per map,
            ///< in place of the tolerance; Criterion::Count needs it
};

/// The default tolerance. Variance: 0.0001 for a light's one world-frame
/// map, whose every detail goes into every product, else 0.0005. L2: 0.01. Linf: 0.002.
double default_tolerance(const SetInfo& info, Criterion criterion);

struct Kept {
  std::size_t coefficients = 0; ///< RGB triples kept, the mean not counted
  double limit = 0;             ///< the largest rank dropped, or its bound
};

/// Sets dropped coefficients of a map transformed by haar_forward() to zero, all channels at once.
Kept apply_threshold(Map& transformed, const ThresholdOptions& options);

struct Quantized {
  std::size_t coefficients = 0; ///< RGB triples left, the mean not counted
  float scale = 0; ///< all differences are halves times it; 0 if any fitting scale can be used
};

/// Thresholds a map transformed by haar_forward() and rounds the coefficients kept.
///
/// Criterion::L2 with a tolerance: one uniform step for all L2-normalised coefficients, the largest
/// that keeps the relative L2 error, dropping and rounding together, within the tolerance; a triple
/// is dropped if its norm is below 0.65 steps, and red and blue are rounded in steps of twice the
/// size from green.
/// Otherwise: apply_threshold(), then rounding by at most the largest coefficient that the
/// criterion allows to be dropped at that place, in steps that are powers of two.
Quantized apply_quantization(Map& transformed, const ThresholdOptions& options);

} // namespace haarlight::wavelet
