#include <html/text.h>

#include <array>
#include <cmath>
#include <cstdio>

namespace haarlight::html {
namespace {

std::string formatted(const char* format, double number) {
  std::array<char, 48> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, number);
  return buffer.data();
}

std::string escaped_character(char c) {
  switch (c) {
  case '&':
    return "&amp;";
  case '<':
    return "&lt;";
  case '>':
    return "&gt;";
  case '"':
    return "&quot;";
  case '\'':
    return "&#39;";
  default:
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? "\uFFFD" : std::string(1, c);
  }
}

} // namespace

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += escaped_character(c);
  return result;
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

std::string fixed(double number) { return formatted("%.1f", number); }

} // namespace haarlight::html
