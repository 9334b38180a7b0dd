#include <wavelet/file/provenance.h>

#include <algorithm>
#include <cassert>
#include <sstream>

namespace haarlight {

void Provenance::set(const std::string& name, const std::string& value) {
  assert(!name.empty() && name.find_first_of("=\n") == std::string::npos);
  assert(value.find('\n') == std::string::npos);
  const auto place = std::find_if(m_entries.begin(), m_entries.end(),
                                  [&](const Entry& entry) { return entry.first == name; });
  if (place != m_entries.end())
    place->second = value;
  else
    m_entries.emplace_back(name, value);
}

std::string Provenance::get(const std::string& name) const {
  for (const auto& [key, value] : m_entries)
    if (key == name)
      return value;
  return {};
}

std::string Provenance::text() const {
  std::string lines;
  for (const auto& [name, value] : m_entries)
    lines.append(name).append("=").append(value).append("\n");
  return lines;
}

Provenance Provenance::parse(const std::string& text) {
  Provenance result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto split = line.find('=');
    if (split != std::string::npos && split > 0)
      result.set(line.substr(0, split), line.substr(split + 1));
  }
  return result;
}

std::string version_text() { return "haarlight " HAARLIGHT_VERSION; }

} // namespace haarlight
