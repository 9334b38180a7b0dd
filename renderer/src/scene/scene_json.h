#pragma once
// The JSON of a scene file: values with their place in the file, and the checks of every field.
// Each error names the place and the expected value.

#include <wavelet/base/geometry.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace haarlight::renderer::detail {

using Json = nlohmann::ordered_json;
using Names = std::vector<std::string_view>;

/// Parses a scene file.
/// @param path named in errors
/// @throws Error(Input) with byte, line and column of a syntax error; also for a key that an object
///         has twice, and beyond 64 levels of nesting
Json parse_json(std::span<const std::byte> bytes, const std::string& path);

/// A value of a scene file. Refers to the value and to the path, which must outlive it.
class SceneNode {
public:
  /// @param where place in the scene, as in `objects[0].radius`; empty for the whole file
  SceneNode(const Json& value, std::string where, const std::string& path)
      : m_value(value), m_where(std::move(where)), m_path(path) {}

  /// @throws Error(Input) "path: where: message"
  [[noreturn]] void fail(const std::string& message) const;
  /// Fails for a name that is not known, and suggests the known name with the smallest edit
  /// distance. @param kind what is named, for example "shape"
  [[noreturn]] void fail_unknown(std::string_view kind, const std::string& name,
                                 const Names& known) const;

  /// Requires an object without any other keys.
  void allow(const Names& keys) const;

  /// The value of a required key.
  SceneNode at(std::string_view key) const;
  /// The value of an optional key.
  std::optional<SceneNode> find(std::string_view key) const;
  bool has(std::string_view key) const { return find(key).has_value(); }

  /// The values of an array or of an object, in the file's order.
  std::vector<SceneNode> elements() const;
  /// The keys of an object, in the file's order.
  std::vector<std::string> keys() const;

  bool is_object() const;
  bool is_array() const;
  bool is_number() const;

  bool boolean() const;
  std::string text() const; ///< not empty, no NUL
  /// Finite and at most 1e18 in magnitude, so that results computed from it stay within float.
  double number() const;
  /// @throws Error(Input) unless low ≤ number ≤ high
  double number_within(double low, double high) const;
  float positive() const;
  long long whole_number() const;
  std::vector<double> numbers(std::size_t count) const;
  Vec3 vector() const;    ///< three numbers
  Vec3 direction() const; ///< three numbers, not all zero
  /// A string that is one of the known names.
  std::string choice(std::string_view kind, const Names& known) const;

private:
  const Json& m_value;
  std::string m_where;
  const std::string& m_path;
};

} // namespace haarlight::renderer::detail
