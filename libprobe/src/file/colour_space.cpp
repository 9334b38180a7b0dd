#include "file/colour_space.h"

#include <Eigen/LU>

#include <cmath>

namespace haarlight::probe {
namespace {

/// Chromaticities are published with four digits; files round them in different ways.
constexpr double chromaticity_rounding = 3e-4;

Eigen::Vector3d xyz_of(const Eigen::Vector2d& xy) {
  return {xy.x() / xy.y(), 1, (1 - xy.x() - xy.y()) / xy.y()};
}

Eigen::Matrix3d bradford() {
  Eigen::Matrix3d m;
  m << 0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296;
  return m;
}

/// RGB to XYZ where (1, 1, 1) becomes the white at luminance 1; nothing if that does not exist.
std::optional<Eigen::Matrix3d> xyz_from_rgb(const Chromaticities& c) {
  Eigen::Matrix3d primaries;
  primaries << c.red.x(), c.green.x(), c.blue.x(), c.red.y(), c.green.y(), c.blue.y(),
      1 - c.red.sum(), 1 - c.green.sum(), 1 - c.blue.sum();
  if (!(std::abs(primaries.determinant()) > 1e-6) || !primaries.allFinite() || !(c.white.y() > 0))
    return std::nullopt;
  const Eigen::Vector3d scale = primaries.inverse() * xyz_of(c.white);
  if (!scale.allFinite() || !(scale.array().abs().minCoeff() > 1e-9))
    return std::nullopt;
  return primaries * scale.asDiagonal();
}

bool same(const Chromaticities& a, const Chromaticities& b) {
  const auto near = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
    return (p - q).cwiseAbs().maxCoeff() < chromaticity_rounding;
  };
  return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) &&
         near(a.white, b.white);
}

bool is_xyz(const Chromaticities& c) {
  return c.red == Eigen::Vector2d(1, 0) && c.green == Eigen::Vector2d(0, 1) &&
         c.blue == Eigen::Vector2d(0, 0);
}

} // namespace

Chromaticities rec709_chromaticities() {
  return {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
}

Chromaticities aces_chromaticities() {
  return {{0.7347, 0.2653}, {0, 1}, {0.0001, -0.0770}, {0.32168, 0.33767}};
}

Eigen::Vector3d icc_white() { return {0.9642, 1, 0.8249}; }

const Eigen::Matrix3d& rec709_from_xyz() {
  static const Eigen::Matrix3d matrix{{3.2404542, -1.5371385, -0.4985314},
                                      {-0.9692660, 1.8760108, 0.0415560},
                                      {0.0556434, -0.2040259, 1.0572252}};
  return matrix;
}

Eigen::Array3d convert_colour(const Eigen::Matrix3d& m, const Eigen::Array3d& v) {
  return m.col(0).array() * v[0] + m.col(1).array() * v[1] + m.col(2).array() * v[2];
}

Eigen::Matrix3d rec709_from_adapted_xyz(const Eigen::Vector3d& white) {
  const Eigen::Matrix3d cone = bradford();
  const Eigen::Vector3d target = cone * xyz_of(rec709_chromaticities().white);
  const Eigen::Vector3d ratio = target.cwiseQuotient(cone * white);
  const Eigen::Matrix3d adapted = cone.inverse() * ratio.asDiagonal() * cone;
  return xyz_from_rgb(rec709_chromaticities())->inverse() * adapted;
}

std::optional<Eigen::Matrix3d> rec709_from_rgb(const Chromaticities& space) {
  const auto to_xyz = xyz_from_rgb(space);
  if (!to_xyz)
    return std::nullopt;
  if (same(space, rec709_chromaticities()))
    return Eigen::Matrix3d::Identity();
  if (is_xyz(space))
    return rec709_from_xyz() * *to_xyz;
  return rec709_from_adapted_xyz(xyz_of(space.white)) * *to_xyz;
}

} // namespace haarlight::probe
