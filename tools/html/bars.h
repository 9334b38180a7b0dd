#pragma once
// Bars over a logarithmic axis, as SVG.

#include <html/plot.h>

#include <string>
#include <vector>

namespace haarlight::html {

struct Bar {
  std::string label; ///< below it
  double value = 0;  ///< none is drawn for what is not positive
  double limit = 0;  ///< what it could be at most, drawn pale behind it; none if not positive
};

/// @param colour of the values
std::string bar_plot(const std::vector<Bar>& bars, const PlotText& text, const std::string& colour);

} // namespace haarlight::html
