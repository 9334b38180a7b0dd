#pragma once
// How far trees would lie from what they are if fewer of their coefficients were kept.

#include <wavelet/file/tree_set.h>

#include <cstdint>
#include <vector>

namespace haarlight::info {

struct KeptPoint {
  std::uint64_t kept = 0; ///< coefficients (RGB triples), the largest of all trees together
  double error = 0;       ///< L2 of what is left out, relative to the L2 of all trees
};

/// The averages of the trees always stay and do not count. Coefficients are ranked by their share
/// of the energy, L2-normalised and colours weighted by luminance, so that by Parseval's identity
/// the rest is the error. From several threads; the result does not depend on their number.
/// @return by rising `kept`, about twenty points a decade, from one coefficient to all that are not
///         zero; nothing if all are
std::vector<KeptPoint> error_curve(const wavelet::TreeSet& set,
                                   const std::vector<wavelet::MapPlace>& trees);

} // namespace haarlight::info
