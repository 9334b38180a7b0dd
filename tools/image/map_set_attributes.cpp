#include <image/map_set_attributes.h>

#include <wavelet/base/error.h>

#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace haarlight::image {
namespace {

using wavelet::Fold;
using wavelet::SetInfo;
using wavelet::SetKind;

constexpr std::array<const char*, 4> kind_names = {"generic", "brdf", "light", "transfer"};
constexpr std::array<const char*, 3> fold_names = {"none", "rotations", "mirrors"};
constexpr int largest_size = 1 << 13; // as .haar files have it
constexpr int most_columns = 1 << 16;

void put(Imf::Header& header, const std::string& name, const std::string& text) {
  header.insert("haarlight:" + name, Imf::StringAttribute(text));
}

void put(Imf::Header& header, const std::string& name, int number) {
  header.insert("haarlight:" + name, Imf::IntAttribute(number));
}

/// Attributes of one file, for which errors name it.
class Attributes {
public:
  Attributes(const Imf::Header& header, const std::string& path) : m_header(header), m_path(path) {}

  const std::string& text(const std::string& name) const {
    return find<Imf::StringAttribute>(name).value();
  }
  int number(const std::string& name, int low, int high) const {
    const int value = find<Imf::IntAttribute>(name).value();
    if (value < low || value > high)
      fail("haarlight:" + name + " is " + std::to_string(value) + ", from " + std::to_string(low) +
           " to " + std::to_string(high) + " is needed");
    return value;
  }
  template <class E>
  E choice(const std::string& name, std::span<const char* const> words) const {
    const std::string& word = text(name);
    for (std::uint32_t i = 0; i < words.size(); ++i)
      if (word == words[i])
        return static_cast<E>(i);
    std::string choices = words.front();
    for (std::size_t i = 1; i < words.size(); ++i)
      choices.append(i + 1 < words.size() ? ", " : " or ").append(words[i]);
    fail("haarlight:" + name + " is '" + word + "', " + choices + " is needed");
  }
  [[noreturn]] void fail(const std::string& message) const { throw_input_error(m_path, message); }

private:
  template <class T>
  const T& find(const std::string& name) const {
    const T* attribute = m_header.findTypedAttribute<T>("haarlight:" + name);
    if (attribute == nullptr)
      fail("lacks the header attribute haarlight:" + name + ", which map sets have");
    return *attribute;
  }

  const Imf::Header& m_header;
  const std::string& m_path;
};

void check_grid(const Attributes& attributes, const SetInfo& info) {
  if (!std::has_single_bit(static_cast<unsigned>(info.size)))
    attributes.fail("haarlight:size is " + std::to_string(info.size) +
                    ", a power of two is needed");
  if (attributes.text("domain") != domain_name)
    attributes.fail("haarlight:domain is '" + attributes.text("domain") + "', '" + domain_name +
                    "' is needed");
}

/// How many rolls the stored rows stand for.
int rolls_of(const SetInfo& info) {
  if (info.kind != SetKind::Brdf)
    return 1;
  const int copies[3] = {1, 4, 8};
  return info.rows * copies[static_cast<std::size_t>(info.fold)];
}

void check_words(const Attributes& attributes, const SetInfo& info) {
  if (info.rolls != rolls_of(info) || (info.kind != SetKind::Brdf && info.fold != Fold::None))
    attributes.fail("haarlight:rolls does not fit kind, rows and fold");
  if (info.frame.find('\n') != std::string::npos || info.units.find('\n') != std::string::npos)
    attributes.fail("haarlight:frame or haarlight:units has a line break");
}

} // namespace

bool has_set_attributes(const Imf::Header& header) {
  return header.findTypedAttribute<Imf::StringAttribute>("haarlight:kind") != nullptr;
}

void set_attributes(Imf::Header& header, const SetInfo& info) {
  put(header, "kind", kind_names[static_cast<std::size_t>(info.kind)]);
  put(header, "domain", domain_name);
  put(header, "size", info.size);
  put(header, "columns", info.columns);
  put(header, "rows", info.rows);
  put(header, "rolls", info.rolls);
  put(header, "fold", fold_names[static_cast<std::size_t>(info.fold)]);
  put(header, "cosine", info.cosine ? 1 : 0);
  put(header, "world_frame", info.world_frame ? 1 : 0);
  put(header, "frame", info.frame);
  put(header, "units", info.units);
  put(header, "provenance", info.provenance.text());
}

SetInfo read_attributes(const Imf::Header& header, const std::string& path) {
  const Attributes attributes(header, path);
  SetInfo info;
  info.kind = attributes.choice<SetKind>("kind", kind_names);
  info.size = attributes.number("size", 1, largest_size);
  info.columns = attributes.number("columns", 1, most_columns);
  info.rows = attributes.number("rows", 1, most_columns);
  info.rolls = attributes.number("rolls", 1, 8 * most_columns);
  info.fold = attributes.choice<Fold>("fold", fold_names);
  info.cosine = attributes.number("cosine", 0, 1) == 1;
  info.world_frame = attributes.number("world_frame", 0, 1) == 1;
  info.frame = attributes.text("frame");
  info.units = attributes.text("units");
  info.provenance = Provenance::parse(attributes.text("provenance"));
  check_grid(attributes, info);
  check_words(attributes, info);
  return info;
}

} // namespace haarlight::image
