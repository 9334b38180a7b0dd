#pragma once
// A fixed font of 5 × 7 pixels for captions: capitals, figures and signs; small letters show as
// capitals.

#include <array>
#include <cstdint>

namespace haarlight::image {

inline constexpr int glyph_width = 5;
inline constexpr int glyph_height = 7;

/// Rows from the top; bit 4 is the leftmost pixel.
struct Glyph {
  std::array<std::uint8_t, glyph_height> rows{};
  bool pixel(int column, int row) const {
    return ((rows[static_cast<std::size_t>(row)] >> (glyph_width - 1 - column)) & 1) != 0;
  }
};

/// Blank for characters the font lacks.
Glyph glyph_of(char character);

} // namespace haarlight::image
