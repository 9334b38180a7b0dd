#pragma once
// Lobes of a BRDF set along lines through the mirror direction.

#include <wavelet/file/tree_set.h>

#include <utility>
#include <vector>

namespace haarlight::info {

enum class Plane {
  Incidence, ///< that of the normal and the mirror direction
  Across     ///< at right angles to it, through the mirror direction
};

/// Luminance in one plane by angle.
struct Lobe {
  double theta = 0; ///< of the mirror direction from the normal, degrees: the middle of its cell
  std::vector<std::pair<double, double>>
      points; ///< degrees from the mirror direction, towards the normal positive, every half degree
              ///< above the horizon; and the value, at least the scale's low end
};

/// What the values of a figure's lobes span.
struct LobeScale {
  double low = 0;  ///< a millionth of the largest: what is less, or negative, is shown as this
  double high = 0; ///< the largest; 0 if no lobe holds anything
};

/// Lobes of some trees, all on one scale.
struct Lobes {
  std::vector<Lobe> lobes;
  LobeScale scale;
};

/// Up to five trees of one row, spread evenly over the columns of those given: small θ_r first.
std::vector<wavelet::MapPlace> spread_places(const std::vector<wavelet::MapPlace>& trees);

/// @param set of BRDF kind
Lobes lobes_of(const wavelet::TreeSet& set, const std::vector<wavelet::MapPlace>& places,
               Plane plane);

} // namespace haarlight::info
