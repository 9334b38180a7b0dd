#pragma once
// Cells of tables.

#include <string>

namespace haarlight::html {

/// A cell of a table: figures to the right.
std::string figure_cell(const std::string& html);
std::string text_cell(const std::string& html);
/// Heads of columns of figures, of text, and of several columns.
std::string figure_head(const std::string& html);
std::string text_head(const std::string& html);
std::string group_head(const std::string& html, int columns);

} // namespace haarlight::html
