#pragma once
// JSON as a plain tree of values, so that the JSON library stays in one source file.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace haarlight::renderer::detail {

struct JsonValue {
  enum class Type { Null, Boolean, Number, String, Array, Object };
  Type type = Type::Null;
  bool boolean = false;
  double number = 0;
  std::string text;
  std::vector<JsonValue> items;  ///< of an array, or the values of an object
  std::vector<std::string> keys; ///< of an object, in the file's order; all different
};

/// "an object", "a number" …
const char* describe(JsonValue::Type type);

/// @param path named in errors
/// @throws Error(Input) with the byte offset where the text stops being JSON, or with the name of a
///         key that an object has twice; also beyond 64 levels of nesting
JsonValue parse_json(std::span<const std::byte> bytes, const std::string& path);

/// User text for a one-line message: in quotes, shortened, without control characters.
std::string quote(const std::string& text);

} // namespace haarlight::renderer::detail
