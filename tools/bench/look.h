#pragma once
// How samplers look in figures, and numbers in text.

#include <renderer/sampler_kind.h>

#include <string>

namespace haarlight::bench {

/// The same in every figure.
struct Look {
  std::string colour;  ///< as in #1f77b4
  int marker = 0;      ///< one of marker_count shapes
  bool dashed = false; ///< biased samplers
};

inline constexpr int marker_count = 5;

Look look_of(renderer::SamplerKind kind);

/// A shape about (x, y) as SVG.
std::string marker_svg(const Look& look, double x, double y);

/// A line with its marker, to stand beside a name.
std::string swatch_svg(const Look& look);

/// Three significant digits, as in 0.00123 or 1.5 × 10⁻⁷ in HTML; a dash for what is unknown.
std::string number_html(double number);

/// A text's &, <, > and quotes made harmless.
std::string escaped(const std::string& text);

/// Four decimals, as in 0.9987; a dash for what is unknown.
std::string ratio_html(double number);

/// Fixed point, for coordinates.
std::string fixed(double number);

} // namespace haarlight::bench
