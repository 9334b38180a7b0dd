#pragma once
// Where an output comes from: an ordered list of names and values that every output carries.

#include <string>
#include <utility>
#include <vector>

namespace haarlight {

/// Sources (base name and hash), options and the version, in the order they were applied. Never a
/// clock time and never a directory, so that the same inputs give the same bytes anywhere.
class Provenance {
public:
  using Entry = std::pair<std::string, std::string>;

  /// Adds an entry, or replaces the value of one of that name.
  /// @param name  non-empty, without '=' or line breaks
  /// @param value without line breaks
  void set(const std::string& name, const std::string& value);

  /// The value of a name, or an empty string.
  std::string get(const std::string& name) const;

  const std::vector<Entry>& entries() const { return m_entries; }

  /// One `name=value` line each, as stored in files.
  std::string text() const;

  /// Reads text() back; lines without '=' are ignored.
  static Provenance parse(const std::string& text);

private:
  std::vector<Entry> m_entries;
};

/// The version of this toolkit, as in `haarlight 0.1.0`.
std::string version_text();

} // namespace haarlight
