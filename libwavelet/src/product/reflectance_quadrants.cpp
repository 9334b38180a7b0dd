#include "product/reflectance_quadrants.h"

#include <wavelet/base/cpu_clones.h>

namespace haarlight::wavelet::detail {
namespace {

/// No square of level l reaches further than this times 2^-l radians from its centre: computed 3.1
/// at level 0, 4.09 at level 4, 4.27 at level 7, with a limit of 4.3.
constexpr float square_radius = 4.4F;

/// Slopes between neighbours are damped by the first factor, because a lobe does not continue as a
/// linear function, and limited such that the density at a corner is at least 1 − 0.8 · 1.6 / 2 =
/// 0.36 of its mean: no sample then weighs more than three times as much as without slopes. Gain of
/// slopes: renderer/ABLATION.md, "Slopes, finer light maps, bounds by the count of samples".
constexpr float slope_damping = 0.8F;
constexpr float largest_slope = 1.6F;

/// Fraction of a square's variance that slopes are not trusted to explain: the part of a lobe that
/// is not linear, and cross terms with the light.
constexpr float unexplained = 0.2F;

/// The quadrants of many squares, as lanes: centres in the light's square, and where those lie in
/// the reflectance's.
struct Lanes {
  int count = 0;
  float side[Pyramid::Places::capacity];
  float height[Pyramid::Places::capacity]; ///< above the horizon, sine
  Pyramid::Places places;
};

void gather(std::span<const Square> squares, const Pyramid& pyramid, Lanes& lanes) {
  lanes.count = 4 * static_cast<int>(squares.size());
  for (std::size_t i = 0; i < squares.size(); ++i)
    for (unsigned q = 0; q < 4; ++q) {
      const Square quadrant = squares[i].quadrant(q);
      const Vec2 centre = quadrant.centre();
      lanes.side[4 * i + q] = quadrant.side();
      lanes.places.u[4 * i + q] = centre.x();
      lanes.places.v[4 * i + q] = centre.y();
      pyramid.set_level(lanes.places, 4 * i + q, quadrant.level);
    }
}

/// Moves points of the light's square to the reflectance's.
void rotate(const ReflectionFrame& reflection, Lanes& lanes) {
  for (int i = 0; i < lanes.count; ++i)
    rotate_point(reflection, lanes.places.u[i], lanes.places.v[i], lanes.height[i]);
}

/// The reflectance over a square's quadrants, those above the horizon.
void look_up(const RotatedReflectance& reflectance, const Lanes& lanes, std::size_t first,
             Quadrants& quadrants) {
  quadrants.reachable = 0;
  for (unsigned q = 0; q < 4; ++q) {
    const std::size_t i = first + q;
    quadrants.reflectance[q] = Float4{};
    const float nearest = lanes.height[i] + square_radius * lanes.side[i];
    if (!(nearest > -reuse_angle))
      continue;
    quadrants.reachable |= 1U << q;
    if (!(nearest > 0)) // below the horizon here, but maybe not where it is reused
      continue;
    quadrants.reflectance[q] = reflectance.pyramid->lookup(
        reflectance.theta_index0, reflectance.theta_index1, reflectance.blend, lanes.places, i);
  }
}

/// Of each quadrant, the value of its neighbour along x; along y.
Float4 beside(Float4 v) { return __builtin_shufflevector(v, v, 1, 0, 3, 2); }
Float4 over(Float4 v) { return __builtin_shufflevector(v, v, 2, 3, 0, 1); }

/// The relative slope from `here` to the neighbour `there`, which lies towards higher coordinates
/// (1) or lower (−1). Over the mean of both, which suits lobes that fall off by ratios.
Float4 slope_between(Float4 here, Float4 there, Float4 towards) {
  return 2 * towards * (there - here) / (here + there + 1e-30F);
}

/// Slopes of light times reflectance as far as the reflectance causes them.
/// @param beside,above densities of the quadrants' light with the reflectance of their neighbours
/// along
///        x and y
void set_slopes(Float4 beside, Float4 above, Quadrants& quadrants) {
  const Float4 x = slope_between(quadrants.density, beside, Float4{1, -1, 1, -1});
  const Float4 y = slope_between(quadrants.density, above, Float4{1, 1, -1, -1});
  const Float4 most = Float4{} + largest_slope;
  const Float4 kept = slope_damping * most / larger(absolute(x) + absolute(y), most);
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
  const Int4 above = (Int4{1, 2, 4, 8} & static_cast<int>(quadrants.reachable)) != 0;
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

HAARLIGHT_CPU_CLONES void evaluate_quadrants(const RotatedReflectance& reflectance, Float4 floor,
                                             Float4 weights, std::span<const Square> squares,
                                             Quadrants* quadrants) {
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
