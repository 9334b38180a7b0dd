#include <info/tables.h>

#include <html/cells.h>
#include <html/text.h>

#include <algorithm>

namespace haarlight::info {
namespace {

using tool::Report;

std::string shown(double number) { return html::number_html(number); }
std::string shown(std::int64_t number) { return std::to_string(number); }
std::string shown(bool truth) { return truth ? "yes" : "no"; }
std::string shown(const std::string& text) { return html::escaped(text); }
std::string shown(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers)
    text.append(text.empty() ? "" : ", ").append(html::number_html(number));
  return text;
}

std::string shown(const Report::Entry& entry) {
  const std::string value = std::visit([](const auto& v) { return shown(v); }, entry.value);
  return entry.unit.empty() ? value : value + " " + html::escaped(entry.unit);
}

bool is_text(const Report::Entry& entry) {
  return std::holds_alternative<std::string>(entry.value);
}

std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return html::escaped(name);
}

std::string head(const Report& row) {
  std::string html = "<table><thead><tr>";
  for (const Report::Entry& entry : row.entries())
    html +=
        is_text(entry) ? html::text_head(words(entry.name)) : html::figure_head(words(entry.name));
  return html + "</tr></thead><tbody>\n";
}

std::string rows_html(const std::vector<Report>& rows) {
  std::string html = head(rows.front());
  for (const Report& row : rows) {
    html += "<tr>";
    for (const Report::Entry& entry : row.entries())
      html += is_text(entry) ? html::text_cell(shown(entry)) : html::figure_cell(shown(entry));
    html += "</tr>\n";
  }
  return html + "</tbody></table>\n";
}

} // namespace

std::string values_html(const Report& report) {
  std::string html = "<table class=\"values\"><tbody>\n";
  for (const Report::Entry& entry : report.entries())
    if (entry.form == Report::Entry::Form::Value)
      html +=
          "<tr>" + html::text_head(words(entry.name)) + html::text_cell(shown(entry)) + "</tr>\n";
  return html + "</tbody></table>\n";
}

std::string part_html(const Report& report, const std::string& name) {
  for (const Report::Entry& entry : report.entries()) {
    if (entry.name != name || entry.parts.empty())
      continue;
    return entry.form == Report::Entry::Form::Rows ? rows_html(entry.parts)
                                                   : values_html(entry.parts.front());
  }
  return {};
}

} // namespace haarlight::info
