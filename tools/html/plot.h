#pragma once
// Curves as SVG; what is up is logarithmic.

#include <html/look.h>

#include <string>
#include <utility>
#include <vector>

namespace haarlight::html {

struct Series {
  std::string label; ///< written at the curve's end, if not empty
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

/// The same over a linear axis of angles.
/// @param ticks degrees, at least one; the axis spans them
std::string angle_plot(const std::vector<Series>& series, const PlotText& text,
                       const std::vector<double>& ticks);

} // namespace haarlight::html
