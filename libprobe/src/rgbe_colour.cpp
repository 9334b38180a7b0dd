#include "rgbe_colour.h"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace haarlight::probe {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Primaries rec709 = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
constexpr Primaries radiance_default = {0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.333, 0.333};
constexpr Primaries zeros = {};

/// Headers round to three digits.
bool nearly_equal(const Primaries& a, const Primaries& b) {
  return std::equal(a.begin(), a.end(), b.begin(),
                    [](double u, double v) { return std::abs(u - v) < 0.002; });
}

Vector3d xyz_of(double x, double y) { return {x, y, 1 - x - y}; }

/// XYZ of the white with luminance 1.
Vector3d white_of(const Primaries& p) { return xyz_of(p[6], p[7]) / p[7]; }

/// RGB to XYZ; (1, 1, 1) becomes the white.
std::optional<Matrix3d> rgb_to_xyz(const Primaries& p) {
  Matrix3d columns;
  columns << xyz_of(p[0], p[1]), xyz_of(p[2], p[3]), xyz_of(p[4], p[5]);
  // Twice the area of the triangle of the primaries, 0.22 for Rec. 709; 0 if they lie on a line.
  if (!(p[7] > 0.01) || !(std::abs(columns.determinant()) > 1e-5))
    return std::nullopt;
  const Vector3d scale = columns.inverse() * white_of(p);
  return columns * scale.asDiagonal();
}

Matrix3d bradford_adaptation(const Vector3d& from, const Vector3d& to) {
  Matrix3d bradford;
  bradford << 0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296;
  const Vector3d gain = (bradford * to).array() / (bradford * from).array();
  return bradford.inverse() * gain.asDiagonal() * bradford;
}

} // namespace

bool are_rec709(const Primaries& primaries) {
  return nearly_equal(primaries, rec709) || nearly_equal(primaries, radiance_default) ||
         primaries == zeros;
}

std::optional<ColourMatrix> primaries_to_rec709(const Primaries& primaries) {
  const std::optional<Matrix3d> to_xyz = rgb_to_xyz(primaries);
  if (!to_xyz)
    return std::nullopt;
  const Matrix3d matrix = rgb_to_xyz(rec709)->inverse() *
                          bradford_adaptation(white_of(primaries), white_of(rec709)) * *to_xyz;
  if (!matrix.allFinite())
    return std::nullopt;
  ColourMatrix rows{};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = matrix(r, c);
  return rows;
}

} // namespace haarlight::probe
