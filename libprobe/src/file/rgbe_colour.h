#pragma once
// Colour spaces of Radiance pictures.

#include "file/colour_space.h"

#include <array>
#include <optional>

namespace haarlight::probe {

/// CIE chromaticities x, y of red, green, blue and white, as in a PRIMARIES line.
using Primaries = std::array<double, 8>;

/// True for primaries that are read as Rec. 709: those of Rec. 709 themselves, Radiance's default
/// (0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333), and eight zeros, which Photoshop writes.
bool are_rec709(const Primaries& primaries);

/// The matrix from RGB of these primaries to linear Rec. 709 RGB. White is adapted to D65 by the
/// Bradford transform (Lam 1985), so that grey stays grey.
/// @return nothing if the primaries do not span a colour space
std::optional<ColourMatrix> primaries_to_rec709(const Primaries& primaries);

} // namespace haarlight::probe
