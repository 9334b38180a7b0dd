#pragma once
// Lobes in the plane of incidence by direction, as SVG.

#include <info/lobes.h>

#include <string>

namespace haarlight::info {

/// The colour of a figure's i-th lobe.
std::string lobe_colour(std::size_t i);
/// As in θ_r = 45°.
std::string lobe_name(const Lobe& lobe);

/// The normal is up, the mirror directions are to the right, marked at the rim, and the viewer is
/// to the left; the distance from the centre is logarithmic, over the lobes' scale.
/// @param lobes in the plane of incidence
/// @param title,unit plain text
std::string polar_plot(const Lobes& lobes, const std::string& title, const std::string& unit);

} // namespace haarlight::info
