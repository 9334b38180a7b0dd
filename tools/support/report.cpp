#include <support/report.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

namespace haarlight::tool {

std::string short_text(double number) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.6g", number);
  return buffer.data();
}

std::string exact_text(double number) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  return {buffer.data(), result.ptr};
}

std::string size_text(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> units = {"B", "KiB", "MiB", "GiB", "TiB"};
  auto amount = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; amount >= 1024 && unit + 1 < units.size(); ++unit)
    amount /= 1024;
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), unit == 0 ? "%.0f %s" : "%.2f %s", amount,
                units[unit]);
  return buffer.data();
}

Report::Entry& Report::entry(const std::string& name) {
  const auto place = std::find_if(m_entries.begin(), m_entries.end(),
                                  [&](const Entry& entry) { return entry.name == name; });
  if (place != m_entries.end())
    return *place;
  m_entries.emplace_back();
  m_entries.back().name = name;
  return m_entries.back();
}

Report& Report::put(const std::string& name, Value value, const std::string& unit) {
  Entry& place = entry(name);
  place.value = std::move(value);
  place.unit = unit;
  return *this;
}

Report& Report::section(const std::string& name) {
  Entry& place = entry(name);
  place.form = Entry::Form::Section;
  if (place.parts.empty())
    place.parts.emplace_back();
  return place.parts.front();
}

Report& Report::row(const std::string& name) {
  Entry& place = entry(name);
  place.form = Entry::Form::Rows;
  return place.parts.emplace_back();
}

namespace {

std::string label_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string numbers_text(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers)
    text.append(text.empty() ? "" : " ").append(short_text(number));
  return text;
}

std::string value_text(const Report::Value& value) {
  struct Visitor {
    std::string operator()(const std::string& text) const { return text; }
    std::string operator()(std::int64_t number) const { return std::to_string(number); }
    std::string operator()(double number) const { return short_text(number); }
    std::string operator()(bool truth) const { return truth ? "yes" : "no"; }
    std::string operator()(const std::vector<double>& numbers) const {
      return numbers_text(numbers);
    }
  };
  return std::visit(Visitor{}, value);
}

std::string padded(const std::string& text, std::size_t width, bool right = false) {
  const std::string gap(width > text.size() ? width - text.size() : 0, ' ');
  return right ? gap + text : text + gap;
}

/// Rows under a line of names, columns aligned to the right.
void append_table(std::string& out, const std::vector<Report>& rows, const std::string& indent) {
  std::vector<std::vector<std::string>> cells;
  cells.emplace_back();
  for (const Report::Entry& entry : rows.front().entries())
    cells.front().push_back(label_of(entry.name));
  for (const Report& row : rows) {
    cells.emplace_back();
    for (const Report::Entry& entry : row.entries())
      cells.back().push_back(value_text(entry.value));
  }
  std::vector<std::size_t> widths(cells.front().size());
  for (const auto& row : cells)
    for (std::size_t i = 0; i < std::min(row.size(), widths.size()); ++i)
      widths[i] = std::max(widths[i], row[i].size());
  for (const auto& row : cells) {
    out += indent;
    for (std::size_t i = 0; i < std::min(row.size(), widths.size()); ++i)
      out += padded(row[i], widths[i] + (i > 0 ? 2 : 0), true);
    out += '\n';
  }
}

void append_text(std::string& out, const Report& report, const std::string& indent) {
  std::size_t width = 0;
  for (const Report::Entry& entry : report.entries())
    if (entry.form == Report::Entry::Form::Value)
      width = std::max(width, entry.name.size());
  for (const Report::Entry& entry : report.entries()) {
    if (entry.form == Report::Entry::Form::Value) {
      out += indent + padded(label_of(entry.name), width + 2) + value_text(entry.value);
      out.append(entry.unit.empty() ? "" : " ").append(entry.unit).append("\n");
      continue;
    }
    out += indent + label_of(entry.name) + '\n';
    if (entry.form == Report::Entry::Form::Rows)
      append_table(out, entry.parts, indent + "  ");
    else
      append_text(out, entry.parts.front(), indent + "  ");
  }
}

using Json = nlohmann::ordered_json;

Json json_of(const Report& report) {
  Json object = Json::object();
  for (const Report::Entry& entry : report.entries()) {
    if (entry.form == Report::Entry::Form::Value) {
      object[entry.name] = std::visit([](const auto& value) { return Json(value); }, entry.value);
    } else if (entry.form == Report::Entry::Form::Section) {
      object[entry.name] = json_of(entry.parts.front());
    } else {
      Json rows = Json::array();
      for (const Report& row : entry.parts)
        rows.push_back(json_of(row));
      object[entry.name] = std::move(rows);
    }
  }
  return object;
}

} // namespace

std::string Report::text() const {
  std::string out;
  append_text(out, *this, "");
  return out;
}

std::string Report::json() const {
  // File names need not be UTF-8: what is not is replaced.
  return json_of(*this).dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

} // namespace haarlight::tool
