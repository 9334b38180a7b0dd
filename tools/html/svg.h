#pragma once
// Pieces of SVG.

#include <string>

namespace haarlight::html {

/// Text at a place. @param attributes as in text-anchor="end"; @param content SVG
std::string text_at(double x, double y, const std::string& attributes, const std::string& content);

/// A command of a path: 'M' or 'L', and where to.
std::string point(char command, double x, double y);

std::string line(double x0, double y0, double x1, double y1, const std::string& colour);

std::string box(double x, double y, double width, double height, const std::string& colour);

/// What a drawing begins with; it ends with </svg>.
std::string svg_head(double width, double height);

} // namespace haarlight::html
