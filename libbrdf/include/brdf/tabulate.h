#pragma once
// MERL tables of analytic models, with invalid cells where measurements have them.

#include <brdf/analytic.h>
#include <brdf/merl_file.h>

#include <cstdint>

namespace haarlight::brdf {

struct TabulateOptions {
  double noise = 0;       ///< σ of multiplicative noise per cell and channel, mean one
  std::uint64_t seed = 1; ///< of the noise; a cell's noise depends on seed, cell and channel only
};

/// Cells whose min(cos θ_i, cos θ_o) at the centre is not above this are invalid, as in the real
/// data.
inline constexpr double lowest_valid_cosine = -0.061;

/// Values at bin centres; invalid cells hold −1. Centres a little below the horizon are valid and
/// take both cosines as at least 0.01, so that interpolation reaches the horizon without darkening.
MerlTable tabulate(const AnalyticBrdf& model, const TabulateOptions& options = {});

} // namespace haarlight::brdf
