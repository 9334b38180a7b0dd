#pragma once
// Cells of the report's tables.

#include <string>

namespace haarlight::bench {

/// A cell of a table: figures to the right.
std::string figure_cell(const std::string& html);
std::string text_cell(const std::string& html);
/// Heads of columns of figures, of text, and of several columns.
std::string figure_head(const std::string& html);
std::string text_head(const std::string& html);
std::string group_head(const std::string& html, int columns);

/// A sampler's name beside its colour, with a mark if it is biased.
std::string sampler_html(const std::string& name);

} // namespace haarlight::bench
