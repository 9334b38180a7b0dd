#pragma once
// From a transformed, thresholded map to a tree.

#include <wavelet/tree/map_set.h>
#include <wavelet/tree/tree.h>

namespace haarlight::wavelet {

/// @param transformed a map after haar_forward(); squares whose three coefficients and all finer
/// ones
///                    are zero get no node
/// @param channels    3, or 1 to store luminance
/// @param scale       of the coefficients, if they fit it; 0 = a power of two that fits them
Tree build_tree(const Map& transformed, int channels, CoefficientType type, float scale = 0);

} // namespace haarlight::wavelet
