#pragma once
// Plots and their parts as SVG.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace haarlight::html {

// Elements. Coordinates are written with one decimal.

/// A number with one decimal.
std::string fixed(double number);
/// The start of a drawing, which ends with </svg>.
std::string svg_head(double width, double height);
/// @param attributes as in text-anchor="end" @param content SVG
std::string text_at(double x, double y, const std::string& attributes, const std::string& content);
/// A bold title. @param text plain text
std::string title_at(double x, double y, const std::string& text);
/// A command of a path: 'M' or 'L' and its point.
std::string path_point(char command, double x, double y);
std::string line(double x0, double y0, double x1, double y1, const std::string& colour);

inline constexpr const char* grid_colour = "#e4e4e4";
inline constexpr const char* axis_colour = "#777";

enum class AxisScale { Logarithmic, Linear };

/// Maps the range of the included values to coordinates from `from` to `to`.
struct Axis {
  AxisScale scale = AxisScale::Logarithmic;
  double low = 1e300;
  double high = -1e300;
  double from = 0;
  double to = 1;

  /// Finite; on a logarithmic axis positive.
  bool can_show(double value) const;
  /// Extends the range by a value that it can show.
  void include(double value);
  /// Adds a margin to a logarithmic axis; call before the functions below.
  void finish();

  double coordinate(double value) const;

  /// Of a logarithmic axis: powers of ten; over less than two decades also 2 and 5 times these.
  std::vector<double> ticks() const;

  /// Label of a tick as SVG: degrees on a linear axis; else a number, or 1, 2 or 5 times a power of
  /// ten.
  std::string tick_label(double value) const;
};

inline constexpr int marker_count = 5;
inline constexpr int no_marker = -1;

/// The style of a curve and its markers.
struct PlotStyle {
  std::string colour;  ///< as in #1f77b4
  int marker = 0;      ///< one of marker_count shapes, or no_marker
  bool dashed = false; ///< with hollow markers
};

/// One of twenty distinct colours on white, in print too; then they repeat.
std::string series_colour(std::size_t index);

/// A line with its marker, to be put beside a name.
std::string swatch_svg(const PlotStyle& style);

struct Series {
  std::string label; ///< written at the end of the curve, if not empty
  PlotStyle style;
  std::vector<std::pair<double, double>> points; ///< connected in this order; those that the axes
                                                 ///< cannot show are left out
};

/// Plain text.
struct PlotText {
  std::string title;
  std::string x;
  std::string y;
};

/// Curves over logarithmic axes. @param ticks of the x axis; empty: as Axis::ticks()
std::string log_plot(const std::vector<Series>& series, const PlotText& text,
                     const std::vector<double>& ticks = {});

/// Curves over a linear axis of angles; the y axis is logarithmic. @param ticks degrees, at least
/// one
std::string angle_plot(const std::vector<Series>& series, const PlotText& text,
                       const std::vector<double>& ticks);

struct Bar {
  std::string label;
  double value = 0; ///< not drawn unless positive
  double limit =
      0; ///< largest possible value, drawn pale behind the bar; not drawn unless positive
};

/// Bars over a logarithmic axis. @param colour of the values
std::string bar_plot(const std::vector<Bar>& bars, const PlotText& text, const std::string& colour);

} // namespace haarlight::html
