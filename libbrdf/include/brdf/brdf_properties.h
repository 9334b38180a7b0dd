#pragma once
// Properties of a measured BRDF that are found by integrating over its table.

#include <brdf/measured_brdf.h>

namespace haarlight::brdf {

/// ∫ f_r(ω, ω_o) max(0, n·ω) dω, averaged over θ_o evenly in [theta_begin, theta_end] (radians,
/// within [0, π/2]); without the cosine, ∫ f_r dω over the hemisphere, if `cosine` is false.
/// Computed by quadrature over the half vector, dω = 4 (h·ω_o) dω_h, on a grid that follows the
/// table's bins of θ_h; error about 0.1 %.
Rgb directional_albedo(const MeasuredBrdf& brdf, double theta_begin, double theta_end,
                       bool cosine = true);

/// How far a table is from bilateral symmetry, f(φ_d) = f(π − φ_d). Isotropic materials have it;
/// measured files have it up to noise, and folding a set by mirrors assumes it.
/// @return mean of |f(φ_d) − f(π − φ_d)| over the mean of f, both of luminance, over the cells that
/// are valid with their mirror image and weighted by the solid angle of half and difference vector.
/// 0 for a perfectly symmetric table, at most 2.
double bilateral_asymmetry(const MeasuredBrdf& brdf);

} // namespace haarlight::brdf
