#include "product/product_kernel.h"

#include <wavelet/base/cpu_clones.h>
#include <wavelet/square/sphere_map.h>

namespace haarlight::wavelet::detail {
namespace {

/// No square of level l reaches further than this times 2^-l radians from its centre.
constexpr float square_radius = 4.4F;

/// Slopes seen between neighbours are taken this far, and no further than that: the integrand must
/// not be missed where it does not go on as it began.
constexpr float kept_slope = 0.8F;
constexpr float most_slope = 1.6F;

/// Share of a square's variance that no slope is trusted to explain.
constexpr float unexplained = 0.2F;

/// The quadrants of many squares, as lanes: centres in the light's square, and where those lie in
/// the reflectance's.
struct Lanes {
  int count = 0;
  float side[Pyramid::Places::capacity];
  float height[Pyramid::Places::capacity]; ///< above the horizon, sine
  Pyramid::Places places;
};

void gather(std::span<const SquarePlace> squares, const Pyramid& pyramid, Lanes& lanes) {
  lanes.count = 4 * static_cast<int>(squares.size());
  for (std::size_t i = 0; i < squares.size(); ++i)
    for (unsigned q = 0; q < 4; ++q) {
      const SquarePlace quadrant = squares[i].quadrant(q);
      const float side = power_of_two(-quadrant.level);
      lanes.side[4 * i + q] = side;
      lanes.places.u[4 * i + q] = (static_cast<float>(quadrant.column) + 0.5F) * side;
      lanes.places.v[4 * i + q] = (static_cast<float>(quadrant.row) + 0.5F) * side;
      pyramid.set_level(lanes.places, 4 * i + q, quadrant.level);
    }
}

/// From points of the light's square to points of the reflectance's.
void rotate(const ReflectionFrame& r, Lanes& lanes) {
  for (int i = 0; i < lanes.count; ++i) {
    float wx = 0;
    float wy = 0;
    float wz = 0;
    square_to_sphere(lanes.places.u[i], lanes.places.v[i], wx, wy, wz);
    const float x = r.frame.t.x() * wx + r.frame.t.y() * wy + r.frame.t.z() * wz;
    const float y = r.frame.b.x() * wx + r.frame.b.y() * wy + r.frame.b.z() * wz;
    const float z = r.frame.n.x() * wx + r.frame.n.y() * wy + r.frame.n.z() * wz;
    lanes.height[i] = r.sin_theta_r * x + r.cos_theta_r * z;
    sphere_to_square(x, y, z, lanes.places.u[i], lanes.places.v[i]);
  }
}

/// The reflectance over a square's quadrants, those above the horizon.
void look_up(const RotatedReflectance& reflectance, const Lanes& lanes, std::size_t first,
             Quadrants& quadrants) {
  quadrants.visible = 0;
  for (unsigned q = 0; q < 4; ++q) {
    const std::size_t i = first + q;
    quadrants.reflectance[q] = Float4{};
    const float nearest = lanes.height[i] + square_radius * lanes.side[i];
    if (!(nearest > -kept_shift))
      continue;
    quadrants.visible |= 1U << q;
    if (!(nearest > 0)) // in reach of points nearby, but dark here
      continue;
    quadrants.reflectance[q] = reflectance.pyramid->lookup(reflectance.entry0, reflectance.entry1,
                                                           reflectance.blend, lanes.places, i);
  }
}

/// Each quadrant's neighbour along x; along y.
Float4 beside(Float4 v) { return __builtin_shufflevector(v, v, 1, 0, 3, 2); }
Float4 over(Float4 v) { return __builtin_shufflevector(v, v, 2, 3, 0, 1); }

/// The relative slope from `here` to the neighbour `there`, which lies towards higher coordinates
/// (1) or lower (−1). Over the mean of both, which suits lobes that fall off by ratios.
Float4 slope_between(Float4 here, Float4 there, Float4 towards) {
  return 2 * towards * (there - here) / (here + there + 1e-30F);
}

/// Slopes of light times reflectance as far as reflectance makes them.
/// @param beside,above densities that the quadrants' light would have with the reflectance of their
///        neighbours along x and y
void set_slopes(Float4 beside, Float4 above, Quadrants& quadrants) {
  const Float4 x = slope_between(quadrants.density, beside, Float4{1, -1, 1, -1});
  const Float4 y = slope_between(quadrants.density, above, Float4{1, 1, -1, -1});
  const Float4 most = Float4{} + most_slope;
  const Float4 kept = kept_slope * most / larger(absolute(x) + absolute(y), most);
  quadrants.slope_x = x * kept;
  quadrants.slope_y = y * kept;
}

/// Densities, slopes and errors, from averages of light and reflectance.
/// @param area of the quadrants if they may be split further, else 0
void combine(Float4 floor, Float4 weights, float area, Quadrants& quadrants) {
  auto [lr, lg, lb, l0] = quadrants.light;
  auto [br, bg, bb, deviation] = quadrants.reflectance;
  transpose(lr, lg, lb, l0);
  transpose(br, bg, bb, deviation);
  const Float4 zero = {};
  const Float4 r = larger(br, zero + floor[0]) * weights[0];
  const Float4 g = larger(bg, zero + floor[1]) * weights[1];
  const Float4 b = larger(bb, zero + floor[2]) * weights[2];
  const auto density = [x = lr, y = lg, z = lb, zero](Float4 red, Float4 green, Float4 blue) {
    return larger(x * red + y * green + z * blue, zero);
  };
  const Int4 above = (Int4{1, 2, 4, 8} & static_cast<int>(quadrants.visible)) != 0;
  quadrants.density = select(above, density(r, g, b), zero);
  set_slopes(density(beside(r), beside(g), beside(b)), density(over(r), over(g), over(b)),
             quadrants);
  const float scale = weights[1] / luminance_lanes[1];
  const Float4 relative = deviation * scale / (r + g + b + 1e-30F);
  const Float4 variance = relative * relative;
  const Float4 squares =
      quadrants.slope_x * quadrants.slope_x + quadrants.slope_y * quadrants.slope_y;
  quadrants.drift = quadrants.density * squares;
  quadrants.error =
      area * quadrants.density * larger(variance - squares / 12, unexplained * variance);
}

float splittable_area(const Pyramid& pyramid, int level) {
  return level < pyramid.levels() ? power_of_two(-2 * level) : 0.0F;
}

} // namespace

HAARLIGHT_CPU_CLONES void weigh(const RotatedReflectance& reflectance, Float4 floor, Float4 weights,
                                std::span<const SquarePlace> squares, Quadrants* quadrants) {
  const Pyramid& pyramid = *reflectance.pyramid;
  Lanes lanes;
  gather(squares, pyramid, lanes);
  rotate(reflectance.reflection, lanes);
  pyramid.place(lanes.places, lanes.count);
  for (std::size_t i = 0; i < squares.size(); ++i) {
    look_up(reflectance, lanes, 4 * i, quadrants[i]);
    combine(floor, weights, splittable_area(pyramid, squares[i].level + 1), quadrants[i]);
  }
}

} // namespace haarlight::wavelet::detail
