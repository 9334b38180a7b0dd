#pragma once
// How a picture of the whole sphere is spread over the plane.
//
// World axes are Debevec's: right +x, up +y, forward −z. Image coordinates (u, v) lie in [0, 1]², u
// with the columns and v with the rows, v = 0 at the top. For the round mappings a = 2u − 1 points
// right, b = 1 − 2v up, and r² = a² + b²; points with r > 1 are no part of the map, whatever stands
// there.
//
// angular     r = angle from forward / π, azimuth kept: the centre looks forward, the rim back,
// right
//             is +x (Debevec's light probes). dω = 4π sin(πr)/r du dv.
// latlong     direction (sin φ sin θ, cos θ, −cos φ sin θ), φ = 2π(u − ½), θ = πv: the centre looks
//             forward, u = ¾ right, u = 0 and 1 back, the top row up (HDRShop). dω = 2π² sin θ du
//             dv.
// mirrorball  orthographic photograph of a mirrored sphere by someone who stands at +z and looks
//             forward: the sphere's normal is (a, b, √(1 − r²)), the centre reflects back (+z), the
//             rim forward, right is +x. dω = 16 du dv.
// octahedral  the square of <wavelet/square/sphere_map.h> in world axes: the centre is +z, u grows
// towards
//             +x and v towards +y. dω = 4π du dv.

#include <wavelet/base/geometry.h>

#include <optional>
#include <string>

namespace haarlight::probe {

enum class Mapping { Angular, LatLong, MirrorBall, Octahedral };

/// As written on the command line: angular, latlong, mirrorball, octahedral.
std::string mapping_name(Mapping mapping);

/// The mapping of a name, or nothing.
std::optional<Mapping> parse_mapping(const std::string& name);

/// Whether the map lies in the disk r ≤ 1 only.
inline bool is_round(Mapping mapping) {
  return mapping == Mapping::Angular || mapping == Mapping::MirrorBall;
}

/// r² of an image point of a round mapping.
inline float radius_squared(const Vec2& uv) { return (2.0F * uv - Vec2(1, 1)).squaredNorm(); }

/// Whether an image point belongs to the map.
inline bool in_map(Mapping mapping, const Vec2& uv) {
  return !is_round(mapping) || radius_squared(uv) <= 1.0F;
}

/// Unit direction of an image point. A point outside a round map gives the rim's direction.
Vec3 image_to_direction(Mapping mapping, const Vec2& uv);

/// Image point of a unit direction, in [0, 1]².
Vec2 direction_to_image(Mapping mapping, const Vec3& w);

/// dω/(du dv) at an image point, steradian per unit square, positive; 4π on average over a whole
/// map. Held at a tiny positive value where it vanishes (the angular rim, the poles of latlong).
float solid_angle_density(Mapping mapping, const Vec2& uv);

} // namespace haarlight::probe
