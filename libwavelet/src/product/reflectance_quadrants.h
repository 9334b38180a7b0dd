#pragma once
// Squares of the light in a reflectance's frame, and what an adaptive product needs to know of
// their quadrants.

#include <wavelet/product/adaptive_product.h>
#include <wavelet/square/sphere_map.h>

#include <array>
#include <span>

namespace haarlight::wavelet::detail {

/// Moves a point (u, v) of the light's square to the same direction's point of the reflectance's
/// square. F: float or Float4.
/// @param height set to the sine of the direction's elevation above the horizon
template <class F>
void rotate_point(const ReflectionFrame& r, F& u, F& v, F& height) {
  F wx;
  F wy;
  F wz;
  square_to_sphere(u, v, wx, wy, wz);
  const F x = r.frame.t.x() * wx + r.frame.t.y() * wy + r.frame.t.z() * wz;
  const F y = r.frame.b.x() * wx + r.frame.b.y() * wy + r.frame.b.z() * wz;
  const F z = r.frame.n.x() * wx + r.frame.n.y() * wy + r.frame.n.z() * wz;
  height = r.sin_theta_r * x + r.cos_theta_r * z;
  sphere_to_square(x, y, z, u, v);
}

/// Products may be reused for points whose normal and mirror direction are up to this far away, in
/// radians, and hence extend as far below the horizon. About the angle between neighbouring pixels
/// of a sphere 40 pixels wide; products of points further away differ too much to be reused.
inline constexpr float reuse_angle = 0.05F;

/// The four quadrants q = qx + 2 qy of a square.
struct Quadrants {
  std::array<Float4, 4> light;       ///< averages, lanes R, G, B, 0
  std::array<Float4, 4> reflectance; ///< lanes R, G, B; 0 below the horizon
  unsigned reachable =
      0;               ///< bit q: part of it lies above the horizon, or less than reuse_angle below
  Float4 density = {}; ///< the product's average weight; 0 if not reachable
  Float4 slope_x = {}; ///< of the density, as far as the reflectance causes it
  Float4 slope_y = {};
  Float4 drift = {}; ///< density times the slopes' squares
  Float4 error = {}; ///< what each leaves of the product's variance if it stays a leaf
};

/// Squares that are evaluated together.
inline constexpr std::size_t square_batch = 16;

/// Evaluates all of the quadrants but their light, which is given.
/// @param floor   of the reflectance, lanes R, G, B
/// @param weights of the channels in densities: luminance, scaled
/// @param squares at most square_batch; as many quadrants
void evaluate_quadrants(const RotatedReflectance& reflectance, Float4 floor, Float4 weights,
                        std::span<const Square> squares, Quadrants* quadrants);

} // namespace haarlight::wavelet::detail
