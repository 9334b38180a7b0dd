#include <html/cells.h>

namespace haarlight::html {

std::string figure_cell(const std::string& html) { return "<td class=\"n\">" + html + "</td>"; }
std::string text_cell(const std::string& html) { return "<td>" + html + "</td>"; }

std::string figure_head(const std::string& html) { return "<th class=\"n\">" + html + "</th>"; }
std::string text_head(const std::string& html) { return "<th>" + html + "</th>"; }

std::string group_head(const std::string& html, int columns) {
  return "<th class=\"group\" colspan=\"" + std::to_string(columns) + "\">" + html + "</th>";
}

} // namespace haarlight::html
