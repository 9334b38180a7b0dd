#include <bench/look.h>

#include <array>
#include <cmath>
#include <cstdio>

namespace haarlight::bench {
namespace {

/// Far apart from each other on white, in print too.
constexpr std::array colours = {"#d4002a", "#f58231", "#c7a200", "#2ca02c", "#111111",
                                "#4363d8", "#911eb4", "#00a5c8", "#f032e6", "#7a7a00",
                                "#9a5b1e", "#7f7f7f", "#00806b", "#8b0046", "#000088",
                                "#e377a2", "#6fae00", "#5aa0e6", "#b05cff", "#4b3621"};

std::string formatted(const char* format, double number) {
  std::array<char, 48> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, number);
  return buffer.data();
}

std::string path(const Look& look, const std::string& data) {
  return "<path d=\"" + data + "\" fill=\"" + (look.dashed ? "#fff" : look.colour) +
         "\" stroke=\"" + look.colour + "\" stroke-width=\"1.5\"/>";
}

} // namespace

Look look_of(renderer::SamplerKind kind) {
  const auto index = static_cast<std::size_t>(kind);
  return {colours[index % colours.size()], static_cast<int>(index) % marker_count,
          renderer::traits(kind).claim == renderer::SamplerClaim::Biased};
}

std::string fixed(double number) { return formatted("%.1f", number); }

std::string marker_svg(const Look& look, double x, double y) {
  const std::string start = std::string("M").append(fixed(x)).append(" ").append(fixed(y));
  switch (look.marker) {
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

std::string number_html(double number) {
  if (!std::isfinite(number))
    return "–";
  if (number == 0)
    return "0";
  const double magnitude = std::abs(number);
  if (magnitude >= 1e-3 && magnitude < 1e5)
    return formatted(magnitude >= 100 ? "%.0f" : magnitude >= 10 ? "%.1f" : "%.3g", number);
  const std::string text = formatted("%.2e", number);
  const std::size_t e = text.find('e');
  return text.substr(0, e) + "·10<sup>" + std::to_string(std::stoi(text.substr(e + 1))) + "</sup>";
}

std::string ratio_html(double number) {
  return std::isfinite(number) ? formatted("%.4f", number) : "–";
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    switch (c) {
    case '&':
      result += "&amp;";
      break;
    case '<':
      result += "&lt;";
      break;
    case '>':
      result += "&gt;";
      break;
    case '"':
      result += "&quot;";
      break;
    default:
      result += c;
    }
  return result;
}

} // namespace haarlight::bench
