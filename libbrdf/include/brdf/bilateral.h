#pragma once
// How far a table is from bilateral symmetry, f(φ_d) = f(π − φ_d). Isotropic matter has it;
// measured files have it up to noise, and folding a set by mirrors supposes it.

#include <brdf/measured_brdf.h>

namespace haarlight::brdf {

/// Mean of |f(φ_d) − f(π − φ_d)| over the mean of f, both of luminance, over the cells that are
/// valid with their mirror image and weighted by the solid angle of half and difference vector. 0
/// for a perfectly symmetric table, at most 2.
double bilateral_asymmetry(const MeasuredBrdf& brdf);

} // namespace haarlight::brdf
