#include "file/colour_space.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace haarlight::probe;

TEST_CASE("Rec. 2020 to Rec. 709 as published", "[colour_space]") {
  const auto matrix =
      rec709_from_rgb({{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}});
  REQUIRE(matrix);
  Eigen::Matrix3d published; // ITU-R BT.2407
  published << 1.6605, -0.5876, -0.0728, -0.1246, 1.1329, -0.0083, -0.0182, -0.1006, 1.1187;
  CHECK((*matrix - published).cwiseAbs().maxCoeff() < 1e-4);
}

TEST_CASE("The white of every space becomes grey", "[colour_space]") {
  const auto aces = rec709_from_rgb(aces_chromaticities());
  REQUIRE(aces);
  CHECK((*aces * Eigen::Vector3d::Ones() - Eigen::Vector3d::Ones()).norm() < 1e-12);
  Eigen::Matrix3d published; // colour-science, ACES2065-1 to linear sRGB by Bradford
  published << 2.5217, -1.1341, -0.3876, -0.2765, 1.3727, -0.0962, -0.0154, -0.1530, 1.1684;
  CHECK((*aces - published).cwiseAbs().maxCoeff() < 1e-3);
  const Eigen::Vector3d white = rec709_from_adapted_xyz(icc_white()) * icc_white();
  CHECK((white - Eigen::Vector3d::Ones()).norm() < 1e-12);
}

TEST_CASE("Rec. 709 and measured XYZ are not adapted, degenerate spaces refused",
          "[colour_space]") {
  CHECK(rec709_from_rgb(rec709_chromaticities())->isIdentity());
  const auto xyz = rec709_from_rgb({{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}});
  REQUIRE(xyz);
  const Eigen::Vector3d d65 = *xyz * Eigen::Vector3d(0.95047, 1, 1.08883);
  CHECK((d65 - Eigen::Vector3d::Ones()).norm() < 1e-3);
  CHECK_FALSE(rec709_from_rgb({{0.3, 0.3}, {0.4, 0.4}, {0.5, 0.5}, {0.3127, 0.3290}}));
  CHECK_FALSE(rec709_from_rgb({{0.64, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.3127, 0}}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(rec709_from_rgb({{nan, 0.33}, {0.3, 0.6}, {0.15, 0.06}, {0.3127, 0.3290}}));
}
