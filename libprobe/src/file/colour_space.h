#pragma once
// Conversion of colours to linear RGB of Rec. 709 primaries and D65 white, the space of Image.

#include <Eigen/Core>

#include <optional>

namespace haarlight::probe {

/// CIE 1931 xy chromaticities of an RGB space.
struct Chromaticities {
  Eigen::Vector2d red;
  Eigen::Vector2d green;
  Eigen::Vector2d blue;
  Eigen::Vector2d white;
};

/// Rec. 709 (ITU-R BT.709-6).
Chromaticities rec709_chromaticities();

/// ACES2065-1, AP0 primaries (SMPTE ST 2065-1).
Chromaticities aces_chromaticities();

/// CIE XYZ of the white of ICC's connection space (D50, ICC.1:2010).
Eigen::Vector3d icc_white();

/// The matrix from CIE XYZ to linear Rec. 709 RGB, white D65 (IEC 61966-2-1), without chromatic
/// adaptation.
const Eigen::Matrix3d& rec709_from_xyz();

/// A colour, as a column, multiplied by a matrix; each row is summed from left to right, so that
/// the result does not depend on how Eigen vectorises.
Eigen::Array3d convert_colour(const Eigen::Matrix3d& matrix, const Eigen::Array3d& colour);

/// The matrix from linear RGB of other primaries to Rec. 709. The white of the space becomes D65
/// by Bradford's chromatic adaptation, so that R = G = B stays grey. The exception is CIE XYZ
/// declared as primaries (1, 0), (0, 1), (0, 0): those are measured values and are not adapted.
/// @return the identity if the space is Rec. 709 to within rounding of its chromaticities; nothing
///         if no such space exists (primaries on one line, a white without luminance, no numbers)
std::optional<Eigen::Matrix3d> rec709_from_rgb(const Chromaticities& space);

/// The matrix from CIE XYZ relative to some white to Rec. 709, adapted as by rec709_from_rgb.
Eigen::Matrix3d rec709_from_adapted_xyz(const Eigen::Vector3d& white);

} // namespace haarlight::probe
