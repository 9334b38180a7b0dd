#pragma once
// What share of light from one direction a BRDF reflects.

#include <brdf/measured_brdf.h>

namespace haarlight::brdf {

/// ∫ f_r(ω, ω_o) max(0, n·ω) dω, averaged over θ_o evenly in [theta_begin, theta_end] (radians,
/// within [0, π/2]); without the cosine, ∫ f_r dω over the hemisphere, if `cosine` is false. Found
/// by quadrature over the half vector, dω = 4 (h·ω_o) dω_h, on a grid that follows the table's bins
/// of θ_h; error about 0.1 %.
Rgb directional_albedo(const MeasuredBrdf& brdf, double theta_begin, double theta_end,
                       bool cosine = true);

} // namespace haarlight::brdf
