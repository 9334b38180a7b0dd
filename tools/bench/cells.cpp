#include <bench/cells.h>

#include <bench/look.h>

namespace haarlight::bench {

std::string figure_cell(const std::string& html) { return "<td class=\"n\">" + html + "</td>"; }
std::string text_cell(const std::string& html) { return "<td>" + html + "</td>"; }

std::string figure_head(const std::string& html) { return "<th class=\"n\">" + html + "</th>"; }
std::string text_head(const std::string& html) { return "<th>" + html + "</th>"; }

std::string group_head(const std::string& html, int columns) {
  return "<th class=\"group\" colspan=\"" + std::to_string(columns) + "\">" + html + "</th>";
}

std::string sampler_html(const std::string& name) {
  const auto kind = renderer::sampler_from_name(name);
  if (!kind)
    return escaped(name);
  const bool biased = renderer::traits(*kind).claim == renderer::SamplerClaim::Biased;
  return swatch_svg(look_of(*kind)) + escaped(name) +
         (biased ? " <span class=\"tag\">biased</span>" : "");
}

} // namespace haarlight::bench
