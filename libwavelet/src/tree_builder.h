#pragma once
// From a transformed, thresholded map to a tree.

#include <wavelet/map_set.h>
#include <wavelet/tree.h>

namespace haarlight::wavelet {

/// @param transformed a map after haar_forward(); squares whose three coefficients and all finer
/// ones
///                    are zero get no node
/// @param channels    3, or 1 to store luminance
Tree build_tree(const Map& transformed, int channels, CoefficientType type);

} // namespace haarlight::wavelet
