#include <html/svg.h>

#include <html/text.h>

namespace haarlight::html {

std::string text_at(double x, double y, const std::string& attributes, const std::string& content) {
  return "<text x=\"" + fixed(x) + "\" y=\"" + fixed(y) + "\" " + attributes + ">" + content +
         "</text>\n";
}

std::string point(char command, double x, double y) {
  return std::string(1, command).append(fixed(x)).append(" ").append(fixed(y));
}

std::string line(double x0, double y0, double x1, double y1, const std::string& colour) {
  return "<path d=\"" + point('M', x0, y0) + point('L', x1, y1) + "\" stroke=\"" + colour +
         "\"/>\n";
}

std::string box(double x, double y, double width, double height, const std::string& colour) {
  return "<rect x=\"" + fixed(x) + "\" y=\"" + fixed(y) + "\" width=\"" + fixed(width) +
         "\" height=\"" + fixed(height) + "\" fill=\"" + colour + "\"/>\n";
}

std::string svg_head(double width, double height) {
  return "<svg viewBox=\"0 0 " + fixed(width) + " " + fixed(height) +
         "\" role=\"img\" fill=\"#333\">\n";
}

} // namespace haarlight::html
