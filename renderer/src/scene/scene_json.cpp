#include "scene/scene_json.h"

#include <wavelet/base/error.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace haarlight::renderer::detail {
namespace {

constexpr std::size_t nesting_max = 64;

std::string without_controls(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
  return text;
}

/// Cut to `length` bytes, but not within a UTF-8 sequence.
std::string shortened(const std::string& text, std::size_t length) {
  if (text.size() <= length)
    return text;
  while (length > 0 && (static_cast<unsigned char>(text[length]) & 0xC0U) == 0x80U)
    --length;
  return text.substr(0, length) + "...";
}

/// Builds the tree from the parser's events.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
public:
  TreeBuilder(JsonValue& root, const std::string& path) : m_root(root), m_path(path) {}

  bool null() override { return put({}); }
  bool boolean(bool value) override {
    JsonValue result;
    result.type = JsonValue::Type::Boolean;
    result.boolean = value;
    return put(std::move(result));
  }
  bool number_integer(number_integer_t value) override {
    return put_number(static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return put_number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t& /*text*/) override {
    return put_number(value);
  }
  bool string(string_t& value) override {
    JsonValue result;
    result.type = JsonValue::Type::String;
    result.text = std::move(value);
    return put(std::move(result));
  }
  bool binary(binary_t& /*value*/) override { return false; } // not in text
  bool start_object(std::size_t /*size*/) override { return open(JsonValue::Type::Object); }
  bool start_array(std::size_t /*size*/) override { return open(JsonValue::Type::Array); }
  bool end_array() override { return close(); }
  bool end_object() override {
    refuse_twins(m_open.back()->keys);
    return close();
  }
  bool key(string_t& name) override {
    m_open.back()->keys.push_back(std::move(name));
    return true;
  }
  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::json::exception& error) override {
    const std::string_view what = error.what();
    const std::size_t tag = what.find("] "); // after the library's own error number
    const std::string message(tag == std::string_view::npos ? what : what.substr(tag + 2));
    throw_input_error(m_path, "is no JSON: " + shortened(without_controls(message), 300),
                      position > 0 ? position - 1 : 0);
  }

private:
  JsonValue& put_place() { return m_open.empty() ? m_root : m_open.back()->items.emplace_back(); }
  bool put(JsonValue value) {
    put_place() = std::move(value);
    return true;
  }
  bool put_number(double value) {
    JsonValue result;
    result.type = JsonValue::Type::Number;
    result.number = value;
    return put(std::move(result));
  }
  bool open(JsonValue::Type type) {
    if (m_open.size() >= nesting_max)
      throw_input_error(m_path, "nests deeper than " + std::to_string(nesting_max) + " levels");
    // The place stays put while it is open: what it is in grows only after it is closed.
    JsonValue& place = put_place();
    place.type = type;
    m_open.push_back(&place);
    return true;
  }
  bool close() {
    m_open.pop_back();
    return true;
  }
  void refuse_twins(std::vector<std::string> keys) const {
    std::sort(keys.begin(), keys.end());
    const auto twin = std::adjacent_find(keys.begin(), keys.end());
    if (twin != keys.end())
      throw_input_error(m_path, "the key " + quote(*twin) + " stands twice in one object");
  }

  JsonValue& m_root;
  const std::string& m_path;
  std::vector<JsonValue*> m_open;
};

} // namespace

const char* describe(JsonValue::Type type) {
  switch (type) {
  case JsonValue::Type::Null:
    return "null";
  case JsonValue::Type::Boolean:
    return "true or false";
  case JsonValue::Type::Number:
    return "a number";
  case JsonValue::Type::String:
    return "a string";
  case JsonValue::Type::Array:
    return "an array";
  case JsonValue::Type::Object:
    return "an object";
  }
  return "";
}

std::string quote(const std::string& text) {
  return '"' + shortened(without_controls(text), 60) + '"';
}

JsonValue parse_json(std::span<const std::byte> bytes, const std::string& path) {
  JsonValue root;
  TreeBuilder builder(root, path);
  const auto* text = reinterpret_cast<const std::uint8_t*>(bytes.data());
  nlohmann::json::sax_parse(text, text + bytes.size(), &builder);
  return root;
}

} // namespace haarlight::renderer::detail
