#include <html/look.h>

#include <html/text.h>

#include <array>

namespace haarlight::html {
namespace {

constexpr std::array colours = {"#d4002a", "#f58231", "#c7a200", "#2ca02c", "#111111",
                                "#4363d8", "#911eb4", "#00a5c8", "#f032e6", "#7a7a00",
                                "#9a5b1e", "#7f7f7f", "#00806b", "#8b0046", "#000088",
                                "#e377a2", "#6fae00", "#5aa0e6", "#b05cff", "#4b3621"};

std::string path(const Look& look, const std::string& data) {
  return "<path d=\"" + data + "\" fill=\"" + (look.dashed ? "#fff" : look.colour) +
         "\" stroke=\"" + look.colour + "\" stroke-width=\"1.5\"/>";
}

} // namespace

std::string series_colour(std::size_t index) { return colours[index % colours.size()]; }

std::string marker_svg(const Look& look, double x, double y) {
  const std::string start = std::string("M").append(fixed(x)).append(" ").append(fixed(y));
  switch (look.marker) {
  case no_marker:
    return {};
  case 0:
    return path(look, start + "m-3.5 0a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0z");
  case 1:
    return path(look, start + "m-3.2 -3.2h6.4v6.4h-6.4z");
  case 2:
    return path(look, start + "m0 -4l4 7h-8z");
  case 3:
    return path(look, start + "m0 -4.4l4.4 4.4l-4.4 4.4l-4.4 -4.4z");
  default:
    return path(look, start + "m0 4l4 -7h-8z");
  }
}

std::string swatch_svg(const Look& look) {
  return "<svg class=\"swatch\" width=\"30\" height=\"12\"><path d=\"M1 6h28\" stroke=\"" +
         look.colour + "\" stroke-width=\"2\"" + (look.dashed ? " stroke-dasharray=\"4 3\"" : "") +
         "/>" + marker_svg(look, 15, 6) + "</svg>";
}

} // namespace haarlight::html
