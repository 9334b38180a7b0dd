#include "scene/scene_json.h"

#include <wavelet/base/error.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace haarlight::renderer::detail {
namespace {

constexpr std::size_t nesting_max = 64;
constexpr double largest_number = 1e18;

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

/// User text for a one-line message: in quotes, shortened, without control characters.
std::string quote(const std::string& text) {
  return '"' + shortened(without_controls(text), 60) + '"';
}

/// Builds the value from the parser's events. The library's own parser accepts duplicate keys, any
/// nesting, and inserts into ordered objects in quadratic time.
class SceneParser : public nlohmann::json_sax<Json> {
public:
  SceneParser(std::string_view text, const std::string& path) : m_text(text), m_path(path) {}

  Json parse() {
    Json::sax_parse(m_text, this);
    return std::move(m_root);
  }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t& /*text*/) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t& /*value*/) override { return false; } // not in text
  bool start_object(std::size_t /*size*/) override { return open(Json::object()); }
  bool start_array(std::size_t /*size*/) override { return open(Json::array()); }
  bool end_array() override { return close(); }
  bool end_object() override {
    std::vector<std::string_view> keys;
    for (const auto& [key, value] : m_open.back()->get_ref<Json::object_t&>())
      keys.push_back(key);
    std::ranges::sort(keys);
    const auto twin = std::ranges::adjacent_find(keys);
    if (twin != keys.end())
      throw_input_error(m_path, "duplicate key " + quote(std::string(*twin)) + " in one object");
    return close();
  }
  bool key(string_t& name) override {
    m_key = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::json::exception& error) override {
    const std::size_t offset = position > 0 ? position - 1 : 0;
    const std::string_view before = m_text.substr(0, offset);
    const auto line = 1 + std::ranges::count(before, '\n');
    const std::size_t column = offset - (before.rfind('\n') + 1) + 1; // npos + 1 is 0
    std::string message = error.what();
    // The library prefixes its own error number and, for most errors, the position.
    for (const std::string& prefix_end :
         {std::string("] "), "column " + std::to_string(column) + ": "})
      if (const std::size_t end = message.find(prefix_end); end != std::string::npos)
        message.erase(0, end + prefix_end.size());
    throw_input_error(m_path,
                      "line " + std::to_string(line) + ", column " + std::to_string(column) +
                          ": invalid JSON: " + shortened(without_controls(message), 300),
                      offset);
  }

private:
  Json& insert(Json value) {
    if (m_open.empty())
      return m_root = std::move(value);
    Json& parent = *m_open.back();
    if (parent.is_array())
      return parent.emplace_back(std::move(value));
    auto& members = parent.get_ref<Json::object_t&>();
    members.emplace_back(std::move(m_key), std::move(value));
    return members.back().second;
  }
  bool put(Json value) {
    insert(std::move(value));
    return true;
  }
  bool open(Json value) {
    if (m_open.size() >= nesting_max)
      throw_input_error(m_path, "nests deeper than " + std::to_string(nesting_max) + " levels");
    // The pointer stays valid: the parent grows only after this value is closed.
    m_open.push_back(&insert(std::move(value)));
    return true;
  }
  bool close() {
    m_open.pop_back();
    return true;
  }

  std::string_view m_text;
  const std::string& m_path;
  Json m_root;
  std::string m_key;
  std::vector<Json*> m_open;
};

const char* describe(const Json& value) {
  switch (value.type()) {
  case Json::value_t::boolean:
    return "true or false";
  case Json::value_t::number_integer:
  case Json::value_t::number_unsigned:
  case Json::value_t::number_float:
    return "a number";
  case Json::value_t::string:
    return "a string";
  case Json::value_t::array:
    return "an array";
  case Json::value_t::object:
    return "an object";
  default:
    return "null";
  }
}

void require(const SceneNode& node, const Json& value, bool is_type, const char* type) {
  if (!is_type)
    node.fail(std::string("must be ") + type + ", is " + describe(value));
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Optimal string alignment distance, ignoring case.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<std::size_t> table((a.size() + 1) * width);
  const auto cell = [&](std::size_t i, std::size_t j) -> std::size_t& {
    return table[i * width + j];
  };
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cell(i, j) = i + j;
        continue;
      }
      const std::size_t differ = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
      cell(i, j) = std::min({cell(i - 1, j) + 1, cell(i, j - 1) + 1, cell(i - 1, j - 1) + differ});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        cell(i, j) = std::min(cell(i, j), cell(i - 2, j - 2) + 1);
    }
  return cell(a.size(), b.size());
}

/// The nearest of the known names, and a list of all, cut when there are many.
std::string suggestion(std::string_view name, const Names& known) {
  constexpr std::size_t compared = 64; // bytes of a name
  constexpr std::size_t listed = 12;
  if (known.empty())
    return "none is known here";
  const auto nearest = std::ranges::min_element(known, {}, [&](std::string_view candidate) {
    return edit_distance(name.substr(0, compared), candidate.substr(0, compared));
  });
  std::string list;
  for (std::size_t i = 0; i < known.size() && i < listed; ++i)
    list += (i > 0 ? ", " : "") + std::string(known[i]);
  return "the nearest known is " + quote(std::string(*nearest)) + " (known: " + list +
         (known.size() > listed ? ", ...)" : ")");
}

} // namespace

Json parse_json(std::span<const std::byte> bytes, const std::string& path) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return SceneParser(text, path).parse();
}

void SceneNode::fail(const std::string& message) const {
  throw_input_error(m_path, m_where.empty() ? message : m_where + ": " + message);
}

void SceneNode::fail_unknown(std::string_view kind, const std::string& name,
                             const Names& known) const {
  fail("unknown " + std::string(kind) + " " + quote(name) + ", " + suggestion(name, known));
}

bool SceneNode::is_object() const { return m_value.is_object(); }
bool SceneNode::is_array() const { return m_value.is_array(); }
bool SceneNode::is_number() const { return m_value.is_number(); }

void SceneNode::allow(const Names& known) const {
  for (const std::string& key : keys())
    if (std::ranges::find(known, key) == known.end())
      fail_unknown("key", key, known);
}

std::optional<SceneNode> SceneNode::find(std::string_view key) const {
  require(*this, m_value, is_object(), "an object");
  for (const auto& [name, value] : m_value.get_ref<const Json::object_t&>())
    if (name == key)
      return SceneNode(value, (m_where.empty() ? "" : m_where + ".") + name, m_path);
  return std::nullopt;
}

SceneNode SceneNode::at(std::string_view key) const {
  const std::optional<SceneNode> node = find(key);
  if (!node)
    fail("the key " + quote(std::string(key)) + " is missing");
  return *node;
}

std::vector<SceneNode> SceneNode::elements() const {
  std::vector<SceneNode> result;
  result.reserve(m_value.size());
  if (is_object()) {
    for (const auto& [name, value] : m_value.get_ref<const Json::object_t&>())
      result.emplace_back(value, m_where + "[" + quote(name) + "]", m_path);
    return result;
  }
  require(*this, m_value, is_array(), "an array");
  for (std::size_t i = 0; i < m_value.size(); ++i)
    result.emplace_back(m_value[i], m_where + "[" + std::to_string(i) + "]", m_path);
  return result;
}

std::vector<std::string> SceneNode::keys() const {
  require(*this, m_value, is_object(), "an object");
  std::vector<std::string> result;
  for (const auto& [name, value] : m_value.get_ref<const Json::object_t&>())
    result.push_back(name);
  return result;
}

bool SceneNode::boolean() const {
  require(*this, m_value, m_value.is_boolean(), "true or false");
  return m_value.get<bool>();
}

std::string SceneNode::text() const {
  require(*this, m_value, m_value.is_string(), "a string");
  auto text = m_value.get<std::string>();
  if (text.empty())
    fail("must not be empty");
  if (text.find('\0') != std::string::npos)
    fail("must not contain a NUL character");
  return text;
}

double SceneNode::number() const {
  require(*this, m_value, is_number(), "a number");
  const auto value = m_value.get<double>();
  if (!(std::abs(value) <= largest_number))
    fail("must lie within -1e18 and 1e18");
  return value;
}

double SceneNode::number_within(double low, double high) const {
  const double value = number();
  const auto plain = [](double bound) {
    const std::string text = std::to_string(bound);
    const std::size_t last = text.find_last_not_of('0');
    return text.substr(0, text[last] == '.' ? last : last + 1);
  };
  if (!(value >= low && value <= high))
    fail("must lie between " + plain(low) + " and " + plain(high));
  return value;
}

float SceneNode::positive() const {
  const auto value = static_cast<float>(number());
  if (!(value > 0))
    fail("must be positive");
  return value;
}

long long SceneNode::whole_number() const {
  const double value = number();
  if (value != std::floor(value))
    fail("must be a whole number");
  return static_cast<long long>(value);
}

std::vector<double> SceneNode::numbers(std::size_t count) const {
  require(*this, m_value, is_array(), "an array");
  if (m_value.size() != count)
    fail("must hold " + std::to_string(count) + " numbers, holds " +
         std::to_string(m_value.size()) + " values");
  std::vector<double> result;
  for (const SceneNode& element : elements())
    result.push_back(element.number());
  return result;
}

Vec3 SceneNode::vector() const {
  const std::vector<double> v = numbers(3);
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Vec3 SceneNode::direction() const {
  Vec3 v = vector();
  if (v == Vec3::Zero())
    fail("must not be the zero vector");
  return v;
}

std::string SceneNode::choice(std::string_view kind, const Names& known) const {
  std::string value = text();
  if (std::ranges::find(known, value) == known.end())
    fail_unknown(kind, value, known);
  return value;
}

} // namespace haarlight::renderer::detail
