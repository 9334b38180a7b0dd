#pragma once
// The numbers of an adaptive product: what the quadrants of many squares weigh, worked out side by
// side so that the processor's lanes are full and its waits overlap.

#include <wavelet/product/adaptive_product.h>

#include <array>
#include <span>

namespace haarlight::wavelet::detail {

/// Products are kept for points whose normal and mirror direction are up to this far away, in
/// radians, and reach that much below the horizon.
inline constexpr float kept_shift = 0.05F;

/// The four quadrants q = qx + 2 qy of a square.
struct Quadrants {
  std::array<Float4, 4> light;       ///< averages, lanes R, G, B, 0
  std::array<Float4, 4> reflectance; ///< lanes R, G, B; 0 below the horizon
  unsigned visible = 0;              ///< bit q: some of it lies above the horizon, or little below
  Float4 density = {};               ///< the product's average weight; 0 below the horizon
  Float4 slope_x = {};               ///< of the density, as far as reflectance makes it
  Float4 slope_y = {};
  Float4 drift = {}; ///< density times the slopes' squares
  Float4 error = {}; ///< what each leaves of the product's variance if it stays a leaf
};

/// Squares that are worked on together.
inline constexpr std::size_t square_batch = 16;

/// Works out all of the quadrants' numbers but their light, which is given.
/// @param floor   of the reflectance, lanes R, G, B
/// @param weights of the channels in densities: luminance, scaled
/// @param squares at most square_batch; as many quadrants
void weigh(const RotatedReflectance& reflectance, Float4 floor, Float4 weights,
           std::span<const SquarePlace> squares, Quadrants* quadrants);

} // namespace haarlight::wavelet::detail
