#include "random_map.h"

#include <wavelet/transform/transform.h>

#include <catch2/catch.hpp>

#include <gsl/gsl_wavelet2d.h>

#include <cmath>
#include <vector>

using namespace haarlight::wavelet;

namespace {

std::vector<double> red_plane(const Map& map) {
  std::vector<double> plane;
  for (std::size_t i = 0; i < map.rgb.size(); i += 3)
    plane.push_back(map.rgb[i]);
  return plane;
}

/// GSL's nonstandard transform: N times the coefficients of the function on the unit square.
std::vector<double> gsl_transform(std::vector<double> plane, int size) {
  gsl_wavelet* wavelet = gsl_wavelet_alloc(gsl_wavelet_haar, 2);
  gsl_wavelet_workspace* work = gsl_wavelet_workspace_alloc(static_cast<std::size_t>(size));
  const auto n = static_cast<std::size_t>(size);
  gsl_wavelet2d_nstransform_forward(wavelet, plane.data(), n, n, n, work);
  gsl_wavelet_workspace_free(work);
  gsl_wavelet_free(wavelet);
  return plane;
}

double gsl_coefficient(const std::vector<double>& gsl, int size, int level, int x, int y, int m) {
  const int h = 1 << level;
  const int column = (m & 1) != 0 ? h + x : x;
  const int row = (m & 2) != 0 ? h + y : y;
  const std::size_t place = static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
                            static_cast<std::size_t>(column);
  return gsl[place] / size;
}

/// Largest difference from GSL's coefficients, of pixels up to 50.
template <class T>
double worst_against_gsl(const Map& map) {
  const int size = map.size;
  const std::vector<double> plane = red_plane(map);
  const auto gsl = gsl_transform(plane, size);
  std::vector<T> ours(plane.begin(), plane.end());
  haar_forward(ours.data(), size, 1);
  double worst = std::abs(static_cast<double>(ours[0]) - gsl[0] / size);
  for (int level = 0; (1 << level) < size; ++level)
    for (int y = 0; y < (1 << level); ++y)
      for (int x = 0; x < (1 << level); ++x)
        for (int m = 1; m <= 3; ++m) {
          const double stored = ours[coefficient_index(size, level, x, y, m)];
          const double expected = gsl_coefficient(gsl, size, level, x, y, m);
          worst = std::max(worst, std::abs(std::ldexp(stored, -level) - expected));
        }
  return worst;
}

} // namespace

TEST_CASE("the Haar transform agrees with GSL's, coefficient by coefficient") {
  for (const int size : {2, 8, 64, 256, 1024}) {
    const Map map = random_map(size, static_cast<unsigned>(size));
    CHECK(worst_against_gsl<double>(map) < 1e-12 * 50);
    CHECK(worst_against_gsl<float>(map) < 1e-6 * 50);
  }
}

TEST_CASE("the inverse transform gives the image back") {
  for (const int size : {1, 2, 16, 128, 512}) {
    const Map map = random_map(size, 7);
    Map copy = map;
    haar_forward(copy.rgb.data(), size, 3);
    haar_inverse(copy.rgb.data(), size, 3);
    float worst = 0;
    for (std::size_t i = 0; i < map.rgb.size(); ++i)
      worst = std::max(worst, std::abs(map.rgb[i] - copy.rgb[i]));
    CHECK(worst <= 50 * 2e-7F * 4);
  }
}

TEST_CASE("every wavelet type has the sign pattern of its definition") {
  for (int m = 1; m <= 3; ++m) {
    float image[4] = {};
    image[coefficient_index(2, 0, 0, 0, m)] = 1;
    haar_inverse(image, 2, 1);
    for (int q = 0; q < 4; ++q) {
      const int sign_x = (q & 1) != 0 ? -1 : 1;
      const int sign_y = (q & 2) != 0 ? -1 : 1;
      const int sign = m == 1 ? sign_x : m == 2 ? sign_y : sign_x * sign_y;
      CHECK(image[q] == static_cast<float>(sign));
    }
  }
}
