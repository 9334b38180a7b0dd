#pragma once
// A distant light as arrays of texels: its averages over the squares of all levels. No GL here.

#include <wavelet/tree/map_set.h>

#include <cstdint>
#include <vector>

namespace haarlight::view {

/// Of one level: 2^level squares a side, row by row, RGBA16F.
struct LightSquares {
  std::vector<std::uint16_t> radiance; ///< R, G, B: average; A: how far the light spreads about
                                       ///< its mean direction, root mean square, radians
  std::vector<std::uint16_t>
      directions; ///< unit mean direction of the square's light, by luminance
};

struct PackedLight {
  int levels = 0;                    ///< of the finest squares, of side 2^-levels
  float unit = 1;                    ///< R, G, B of `radiance` times this are W m⁻² sr⁻¹
  std::vector<LightSquares> squares; ///< of levels 0 … `levels`

  std::size_t bytes() const;
};

/// @param map of the light in its own frame, never negative
PackedLight pack_light(const wavelet::Map& map);

/// The spread of light that is even over a square of level 0, radians; each level halves it.
inline constexpr float even_spread = 1.4472025F; // √(4π/6)

} // namespace haarlight::view
