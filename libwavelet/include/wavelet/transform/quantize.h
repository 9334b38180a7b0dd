#pragma once
// Rounding of kept coefficients to multiples of a step tied to the tolerance, so that a packed
// file becomes small. The values stay what a mapped file can hold exactly.

#include <wavelet/transform/threshold.h>

namespace haarlight::wavelet {

struct Quantized {
  std::size_t coefficients = 0; ///< RGB triples left, the mean not counted
  float scale = 0; ///< all differences are halves times it; 0 where any fitting scale serves
};

/// Thresholds a map transformed by haar_forward() and rounds what is kept.
///
/// Criterion::L2 with a tolerance: one uniform step for all L2-normalised coefficients, the largest
/// that keeps the relative L2 error, dropping and rounding together, within the tolerance; a triple
/// is dropped if its norm is below 0.65 steps, and red and blue are rounded in steps of twice the
/// size from green.
/// Otherwise: apply_threshold(), then rounding by at most what the criterion lets be dropped at
/// that place, in steps that are powers of two.
Quantized apply_quantization(Map& transformed, const ThresholdOptions& options);

} // namespace haarlight::wavelet
