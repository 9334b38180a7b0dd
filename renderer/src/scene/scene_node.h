#pragma once
// A JSON value together with its place in the scene, and the checks that every field goes through:
// each says where the trouble is and what would be right.

#include "scene/scene_json.h"

#include <wavelet/base/geometry.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace haarlight::renderer::detail {

using Names = std::vector<std::string_view>;

/// The one of some names that takes the fewest edits (insert, delete, replace, swap; case apart) to
/// become `name`; empty if there are none.
std::string_view nearest_name(std::string_view name, const Names& known);

class SceneNode {
public:
  /// @param where as in `objects[0].radius`; empty for the whole file
  SceneNode(const JsonValue& value, std::string where, const std::string& path)
      : m_value(value), m_where(std::move(where)), m_path(path) {}

  /// @throws Error(Input) "path: where: message"
  [[noreturn]] void fail(const std::string& message) const;

  /// The same for a name that is none of those known, with the nearest. @param what it names, as in
  /// "shape"
  [[noreturn]] void fail_unknown(std::string_view what, const std::string& name,
                                 const Names& known) const;

  /// Requires an object that has none but these keys.
  void allow(const Names& keys) const;

  /// A key's value, required or not.
  SceneNode at(std::string_view key) const;
  std::optional<SceneNode> find(std::string_view key) const;
  bool has(std::string_view key) const { return find(key).has_value(); }

  /// The values of an array, or of an object with their keys.
  std::vector<SceneNode> elements() const;
  const std::vector<std::string>& keys() const;

  bool is_object() const { return m_value.type == JsonValue::Type::Object; }
  bool is_array() const { return m_value.type == JsonValue::Type::Array; }
  bool is_number() const { return m_value.type == JsonValue::Type::Number; }

  bool boolean() const;
  std::string text() const; ///< not empty, no NUL
  /// Finite and at most 1e18 in size, so that nothing computed from it leaves the range of float.
  double number() const;
  float positive() const;
  long long whole_number() const;
  std::vector<double> numbers(std::size_t count) const;
  Vec3 vector() const;    ///< three numbers
  Vec3 direction() const; ///< not all zero
  /// A string that is one of these.
  std::string choice(std::string_view what, const Names& known) const;

private:
  void require(JsonValue::Type type) const;

  const JsonValue& m_value;
  std::string m_where;
  const std::string& m_path;
};

} // namespace haarlight::renderer::detail
