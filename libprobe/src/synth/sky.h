#pragma once
// The daylight model of Preetham, Shirley and Smits, "A practical analytic model for daylight",
// 1999.

#include <probe/synth.h>

namespace haarlight::probe {

/// @param to_sun   unit vector
/// @param turbidity 2 to 10
std::unique_ptr<Scene> make_sun_sky(const Vec3& to_sun, double turbidity);

} // namespace haarlight::probe
