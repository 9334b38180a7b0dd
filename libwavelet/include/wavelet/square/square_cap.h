#pragma once
// Bounding caps of squares on the sphere, and the fraction of a square on which a smooth function
// is positive.

#include <wavelet/square/sphere_map.h>
#include <wavelet/square/square.h>

#include <array>

namespace haarlight::wavelet {

/// A spherical cap that holds all directions of a square.
struct SquareCap {
  Vec3 centre = Vec3::UnitZ(); ///< the square's
  float cosine = -1;           ///< of the cap's angular radius …
  float sine = 0;              ///< … which is at most π/2 from level 1 on
};

SquareCap square_cap(const Square& square);

/// Values of a function at 3 × 3 points of a square: its corners, its edges' middles, its centre;
/// index 3 · row + column.
using SquareValues = std::array<float, 9>;

/// Whether the function is close enough to linear over the square for positive_fraction().
bool nearly_linear(const SquareValues& values);

/// The fraction of the square on which the biquadratic through the values is positive: exact along
/// columns or rows, by Gauss quadrature across them.
float positive_fraction(const SquareValues& values);

/// Directions of the 3 × 3 points of a square, in three batches of lanes; the last batch holds the
/// centre alone, four times.
struct SquareDirections {
  std::array<Float4, 3> x, y, z;
};
SquareDirections square_directions(const Square& square);

/// The fraction of a square on which a smooth function of direction is positive, which by equal
/// area is the share of the solid angle: error below 1e-3 of a square, and mostly far below it.
/// @param value Float4(Float4 x, Float4 y, Float4 z) of four unit directions
template <class Value>
float positive_fraction_of(const Square& square, const Value& value) {
  constexpr std::int32_t coarsest = 5; ///< coarser ones may bend or hold a seam of the map
  constexpr std::int32_t finest = 14;
  const SquareDirections at = square_directions(square);
  SquareValues values;
  for (std::size_t i = 0; i < 3; ++i) {
    const Float4 four = value(at.x[i], at.y[i], at.z[i]);
    for (std::size_t lane = 0; lane < 4 && 4 * i + lane < 9; ++lane)
      values[4 * i + lane] = four[static_cast<int>(lane)];
  }
  if (square.level >= finest || (square.level >= coarsest && nearly_linear(values)))
    return positive_fraction(values);
  float sum = 0;
  for (unsigned q = 0; q < 4; ++q)
    sum += positive_fraction_of(square.quadrant(q), value);
  return 0.25F * sum;
}

} // namespace haarlight::wavelet
