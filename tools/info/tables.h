#pragma once
// Reports as HTML.

#include <support/report.h>

#include <string>

namespace haarlight::info {

/// Its single values, one row each, under their names; sections and lists are left out.
std::string values_html(const tool::Report& report);

/// The entry of that name: a section as values_html(), a list of rows as a table; nothing if there
/// is none.
std::string part_html(const tool::Report& report, const std::string& name);

} // namespace haarlight::info
