#include "scene/scene_node.h"

#include <wavelet/base/error.h>

#include <algorithm>
#include <cmath>

namespace haarlight::renderer::detail {
namespace {

constexpr double largest_number = 1e18;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Optimal string alignment distance.
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

/// "known: a, b, c", cut when there are many.
std::string listed(const Names& names) {
  std::string text = "known: ";
  for (std::size_t i = 0; i < names.size() && i < 12; ++i)
    text += (i > 0 ? ", " : "") + std::string(names[i]);
  return names.size() > 12 ? text + ", ..." : text;
}

std::string suggestion(std::string_view name, const Names& known) {
  if (known.empty())
    return "none is known here";
  return "the nearest known is " + quote(std::string(nearest_name(name, known))) + " (" +
         listed(known) + ")";
}

} // namespace

std::string_view nearest_name(std::string_view name, const Names& known) {
  constexpr std::size_t compared = 64; // bytes of a name that count
  std::string_view best;
  std::size_t fewest = std::string_view::npos;
  for (const std::string_view candidate : known) {
    const std::size_t edits =
        edit_distance(name.substr(0, compared), candidate.substr(0, compared));
    if (edits < fewest) {
      fewest = edits;
      best = candidate;
    }
  }
  return best;
}

void SceneNode::fail(const std::string& message) const {
  throw_input_error(m_path, m_where.empty() ? message : m_where + ": " + message);
}

void SceneNode::fail_unknown(std::string_view what, const std::string& name,
                             const Names& known) const {
  fail("unknown " + std::string(what) + " " + quote(name) + ", " + suggestion(name, known));
}

void SceneNode::require(JsonValue::Type type) const {
  if (m_value.type != type)
    fail(std::string("must be ") + describe(type) + ", is " + describe(m_value.type));
}

void SceneNode::allow(const Names& known) const {
  require(JsonValue::Type::Object);
  for (const std::string& key : m_value.keys)
    if (std::find(known.begin(), known.end(), key) == known.end())
      fail_unknown("key", key, known);
}

std::optional<SceneNode> SceneNode::find(std::string_view key) const {
  require(JsonValue::Type::Object);
  const auto place = std::find(m_value.keys.begin(), m_value.keys.end(), key);
  if (place == m_value.keys.end())
    return std::nullopt;
  const auto index = static_cast<std::size_t>(place - m_value.keys.begin());
  return SceneNode(m_value.items[index], (m_where.empty() ? "" : m_where + ".") + std::string(key),
                   m_path);
}

SceneNode SceneNode::at(std::string_view key) const {
  const std::optional<SceneNode> node = find(key);
  if (!node)
    fail("the key " + quote(std::string(key)) + " is missing");
  return *node;
}

std::vector<SceneNode> SceneNode::elements() const {
  std::vector<SceneNode> result;
  if (!is_object())
    require(JsonValue::Type::Array);
  result.reserve(m_value.items.size());
  for (std::size_t i = 0; i < m_value.items.size(); ++i) {
    const std::string index = is_object() ? quote(m_value.keys[i]) : std::to_string(i);
    result.emplace_back(m_value.items[i], m_where + "[" + index + "]", m_path);
  }
  return result;
}

const std::vector<std::string>& SceneNode::keys() const {
  require(JsonValue::Type::Object);
  return m_value.keys;
}

bool SceneNode::boolean() const {
  require(JsonValue::Type::Boolean);
  return m_value.boolean;
}

std::string SceneNode::text() const {
  require(JsonValue::Type::String);
  if (m_value.text.empty())
    fail("must not be empty");
  if (m_value.text.find('\0') != std::string::npos)
    fail("must not contain a NUL character");
  return m_value.text;
}

double SceneNode::number() const {
  require(JsonValue::Type::Number);
  if (!(std::abs(m_value.number) <= largest_number))
    fail("must lie within -1e18 and 1e18");
  return m_value.number;
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
  require(JsonValue::Type::Array);
  if (m_value.items.size() != count)
    fail("must hold " + std::to_string(count) + " numbers, holds " +
         std::to_string(m_value.items.size()) + " values");
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

std::string SceneNode::choice(std::string_view what, const Names& known) const {
  std::string value = text();
  if (std::find(known.begin(), known.end(), value) == known.end())
    fail_unknown(what, value, known);
  return value;
}

} // namespace haarlight::renderer::detail
