#pragma once
// Results of a program: named values, printed as aligned text or as one JSON object.

#include <cstdint>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace haarlight::tool {

/// part / whole; 0 if the whole is 0.
inline double fraction(double part, double whole) { return whole > 0 ? part / whole : 0; }

/// Six significant digits, as in 0.00123 or 1.5e-07.
std::string short_text(double number);
/// Enough digits to read the same number back.
std::string exact_text(double number);
/// Bytes as in `1.25 MiB`.
std::string size_text(std::uint64_t bytes);

/// An ordered list of entries. Names are JSON keys in snake_case; the text form shows them with
/// spaces. Numbers that are not finite become null in JSON.
class Report {
public:
  using Value = std::variant<std::string, std::int64_t, double, bool, std::vector<double>>;

  struct Entry;

  /// @param value text, a boolean, an integer, a real number, or a list of real numbers
  /// @param unit  shown after the value in the text form only, so the name should imply it
  template <class T>
  Report& add(const std::string& name, const T& value, const std::string& unit = {}) {
    if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::vector<double>>)
      return put(name, Value(value), unit);
    else if constexpr (std::is_integral_v<T>)
      return put(name, Value(static_cast<std::int64_t>(value)), unit);
    else if constexpr (std::is_floating_point_v<T>)
      return put(name, Value(static_cast<double>(value)), unit);
    else
      return put(name, Value(std::string(value)), unit);
  }

  /// A nested object. The reference is valid until the next call on this report.
  Report& section(const std::string& name);
  /// Appends an object to the list `name`, which the text form shows as a table; all rows of a list
  /// must have the same names. The reference is valid until the next call on this report.
  Report& row(const std::string& name);

  std::string text() const;
  std::string json() const;
  const std::vector<Entry>& entries() const { return m_entries; }

private:
  Report& put(const std::string& name, Value value, const std::string& unit);
  Entry& entry(const std::string& name);

  std::vector<Entry> m_entries;
};

struct Report::Entry {
  std::string name;
  Value value;
  std::string unit;
  std::vector<Report> parts; ///< of a section (one) or of a list of rows
  enum class Form { Value, Section, Rows } form = Form::Value;
};

} // namespace haarlight::tool
