#pragma once
// Logarithmic axes of plots.

#include <string>
#include <vector>

namespace haarlight::bench {

/// From one coordinate to another, of what it has taken.
struct Axis {
  double low = 1e300;
  double high = 0;
  double from = 0;
  double to = 1;

  /// @param value > 0
  void take(double value);
  /// Leaves some room on both sides; before anything below.
  void finish();

  double place(double value) const;

  /// Powers of ten; 2 and 5 times these as well where they would be few.
  std::vector<double> ticks() const;
};

/// Of 1, 2 or 5 times a power of ten, or of a number of samples, as SVG.
std::string tick_text(double value);

} // namespace haarlight::bench
