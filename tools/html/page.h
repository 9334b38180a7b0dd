#pragma once
// HTML pages that need no other file and no network: text, numbers, tables, pictures.

#include <image/png.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace haarlight::html {

/// Plain text as HTML: &, <, > and quotes are escaped; control characters become U+FFFD.
std::string escaped(const std::string& text);

/// Three significant digits as HTML, as in 0.00123 or 1.5·10⁻⁷; a dash for numbers that are not
/// finite.
std::string number_html(double number);

/// Four decimals, as in 0.9987; a dash for numbers that are not finite.
std::string ratio_html(double number);

/// A cell of a table; its content is HTML.
struct Cell {
  enum class Style { Text, Number, Outlier, Group };
  std::string html;
  Style style = Style::Text; ///< numbers are aligned right; outliers are red numbers; a group is
                             ///< the centred head of several columns
  int columns = 1;
};

inline Cell number_cell(const std::string& html) { return {html, Cell::Style::Number}; }
inline Cell group_cell(const std::string& html, int columns) {
  return {html, Cell::Style::Group, columns};
}

using TableRow = std::vector<Cell>;

/// A table with rows of heads and rows of cells.
std::string table(const std::vector<TableRow>& heads, const std::vector<TableRow>& rows);

/// A table of two columns: names, which are heads, and values.
std::string value_table(const std::vector<TableRow>& rows);

/// Base64 (RFC 4648) with padding.
std::string base64(std::span<const std::byte> bytes);

/// A picture's PNG file as a data URI. @throws Error(Output)
std::string png_uri(const Image& picture, const image::PngOptions& options = {});

/// A page. @param title plain text @param style CSS @param body HTML
std::string document(const std::string& title, const std::string& style, const std::string& body);

/// A page with the style of haarlight's reports.
std::string report_page(const std::string& title, const std::string& body);

/// Writes a small file, whole or not at all. @throws Error(Output)
void write_text(const std::string& path, const std::string& text);

} // namespace haarlight::html
