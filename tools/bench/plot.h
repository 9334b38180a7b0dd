#pragma once
// Curves over logarithmic axes, as SVG.

#include <bench/look.h>

#include <string>
#include <utility>
#include <vector>

namespace haarlight::bench {

struct Series {
  std::string label; ///< written at the curve's end
  Look look;
  std::vector<std::pair<double, double>>
      points; ///< joined in this order; what is not positive is left out
};

struct PlotText {
  std::string title;
  std::string x;
  std::string y;
};

/// @param ticks where the x axis is marked; empty = at 1, 2 and 5 times powers of ten
std::string log_plot(const std::vector<Series>& series, const PlotText& text,
                     const std::vector<double>& ticks = {});

} // namespace haarlight::bench
