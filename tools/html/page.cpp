#include <html/page.h>

#include <wavelet/file/output_file.h>

#include <array>
#include <cmath>
#include <cstdio>

namespace haarlight::html {
namespace {

constexpr const char* report_style =
    R"(body { font: 14px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif;
  color: #222; background: #fff; max-width: 1240px; margin: 32px auto; padding: 0 24px; }
h1 { font-size: 26px; margin: 0 0 4px; } h2 { font-size: 20px; margin: 40px 0 10px; }
h2 small { font-weight: 400; color: #777; } h3 { font-size: 15px; margin: 24px 0 8px; }
p, li { max-width: 860px; }
table { display: block; overflow-x: auto; border-collapse: collapse; font-size: 12.5px;
  font-variant-numeric: tabular-nums; margin-bottom: 12px; }
th { text-align: left; font-weight: 600; color: #555; padding: 3px 9px; vertical-align: bottom; }
th.group { text-align: center; border-bottom: 1px solid #bbb; }
td { padding: 3px 9px; border-top: 1px solid #e8e8e8; white-space: nowrap; }
td.n, th.n { text-align: right; } td.off { color: #c00020; font-weight: 600; }
tbody tr:hover { background: #f5f7fa; }
.swatch { vertical-align: middle; margin-right: 6px; }
.tag { font-size: 11px; color: #8a5a00; background: #fff1d6; border-radius: 3px; padding: 0 4px; }
.plots { display: grid; grid-template-columns: 1fr 1fr; gap: 12px; margin-bottom: 14px; }
.plots svg { width: 100%; font-size: 11.5px; }
.pictures { display: flex; flex-wrap: wrap; gap: 14px; }
figure { margin: 0; font-size: 12px; width: 128px; }
figure > img { display: block; image-rendering: pixelated; margin-bottom: 4px; background: #000; }
figcaption { line-height: 1.3; }
.legend { width: 128px; height: 128px; margin-bottom: 4px; color: #555; font-size: 10.5px;
  display: flex; flex-direction: column; justify-content: center; }
.legend img { width: 128px; height: 14px; }
.legend div { display: flex; justify-content: space-between; font-size: 9.5px; }
section { border-top: 2px solid #222; margin-top: 48px; } section h2 { margin-top: 14px; }
img.wide { max-width: 100%; image-rendering: pixelated; background: #000; }
table.values td { white-space: normal; } table.values th { white-space: nowrap; }
.maps figure { width: 384px; } .maps img { width: 384px; image-rendering: auto; }
sup { line-height: 0; } code { font-size: 92%; }
)";

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

std::string cell_html(const std::string& element, const Cell& cell) {
  static constexpr std::array classes = {"", " class=\"n\"", " class=\"n off\"",
                                         " class=\"group\""};
  std::string tag = element + classes[static_cast<std::size_t>(cell.style)];
  if (cell.columns > 1)
    tag += " colspan=\"" + std::to_string(cell.columns) + "\"";
  return "<" + tag + ">" + cell.html + "</" + element + ">";
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

std::string table(const std::vector<TableRow>& heads, const std::vector<TableRow>& rows) {
  std::string html = "<table><thead>";
  for (const TableRow& row : heads) {
    html += "<tr>";
    for (const Cell& cell : row)
      html += cell_html("th", cell);
    html += "</tr>";
  }
  html += "</thead><tbody>\n";
  for (const TableRow& row : rows) {
    html += "<tr>";
    for (const Cell& cell : row)
      html += cell_html("td", cell);
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

std::string value_table(const std::vector<TableRow>& rows) {
  std::string html = "<table class=\"values\"><tbody>\n";
  for (const TableRow& row : rows)
    html += "<tr>" + cell_html("th", row[0]) + cell_html("td", row[1]) + "</tr>\n";
  return html + "</tbody></table>\n";
}

std::string base64(std::span<const std::byte> bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (i + k < bytes.size() ? std::to_integer<unsigned>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63U];
  }
  return text;
}

std::string png_uri(const Image& picture, const image::PngOptions& options) {
  const std::string bytes = image::png_bytes(picture, options);
  return "data:image/png;base64," + base64(std::as_bytes(std::span(bytes)));
}

std::string document(const std::string& title, const std::string& style, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
         escaped(title) + "</title>\n<style>\n" + style + "</style>\n</head>\n<body>\n" + body +
         "</body>\n</html>\n";
}

std::string report_page(const std::string& title, const std::string& body) {
  return document(title, report_style, body);
}

void write_text(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

} // namespace haarlight::html
