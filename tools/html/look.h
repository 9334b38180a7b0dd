#pragma once
// How curves and their markers look.

#include <cstddef>
#include <string>

namespace haarlight::html {

/// The same in every figure.
struct Look {
  std::string colour;  ///< as in #1f77b4
  int marker = 0;      ///< one of marker_count shapes, or no_marker
  bool dashed = false; ///< with hollow markers
};

inline constexpr int marker_count = 5;
inline constexpr int no_marker = -1;

/// One of twenty colours far apart from each other on white, in print too; then they repeat.
std::string series_colour(std::size_t index);

/// A shape about (x, y) as SVG.
std::string marker_svg(const Look& look, double x, double y);

/// A line with its marker, to stand beside a name.
std::string swatch_svg(const Look& look);

} // namespace haarlight::html
