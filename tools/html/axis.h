#pragma once
// Axes of plots.

#include <string>
#include <vector>

namespace haarlight::html {

enum class AxisScale { Logarithmic, Linear };

/// From one coordinate to another, of what it has taken.
struct Axis {
  AxisScale scale = AxisScale::Logarithmic;
  double low = 1e300;
  double high = -1e300;
  double from = 0;
  double to = 1;

  /// On a logarithmic axis what is positive.
  bool can_show(double value) const;
  /// @param value that it can show
  void take(double value);
  /// Leaves some room on both sides of a logarithmic axis; before anything below.
  void finish();

  double place(double value) const;

  /// Of a logarithmic axis: powers of ten; 2 and 5 times these as well where they would be few.
  std::vector<double> ticks() const;

  /// As SVG: an angle, or 1, 2 or 5 times a power of ten, or a number of samples.
  std::string tick_text(double value) const;
};

} // namespace haarlight::html
