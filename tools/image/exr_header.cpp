#include <image/exr_header.h>

#include <image/exr_chunks.h>
#include <image/exr_stream.h>

#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <span>
#include <string_view>

namespace haarlight::image {
namespace {

constexpr std::uint32_t magic_number = 20000630;
constexpr std::uint32_t format_version = 2;
constexpr std::uint32_t tiled_flag = 0x200;
constexpr std::uint32_t long_names_flag = 0x400;
constexpr std::uint32_t deep_flag = 0x800;
constexpr std::uint32_t multipart_flag = 0x1000;
constexpr std::size_t longest_name = 255;
constexpr int most_channels = 1024; ///< render passes have some hundreds

/// Bytes of the attribute types whose size is fixed (OpenEXR, "The OpenEXR File Layout"). OpenEXR
/// reads that many whatever size the file states.
const std::map<std::string_view, std::uint32_t>& fixed_sizes() {
  static const std::map<std::string_view, std::uint32_t> sizes = {
      {"box2f", 16},         {"box2i", 16},    {"chromaticities", 32},
      {"compression", 1},    {"double", 8},    {"envmap", 1},
      {"deepImageState", 1}, {"float", 4},     {"int", 4},
      {"keycode", 28},       {"lineOrder", 1}, {"m33d", 72},
      {"m33f", 36},          {"m44d", 128},    {"m44f", 64},
      {"rational", 8},       {"tiledesc", 9},  {"timecode", 8},
      {"v2d", 16},           {"v2f", 8},       {"v2i", 8},
      {"v3d", 24},           {"v3f", 12},      {"v3i", 12}};
  return sizes;
}

/// Steps through bytes that may be malformed.
class Walker {
public:
  Walker(const InputFile& file, std::size_t at, std::size_t end)
      : m_file(file), m_bytes(file.bytes().first(end)), m_at(at) {}

  std::size_t position() const { return m_at; }
  std::size_t left() const { return m_bytes.size() - m_at; }

  std::uint32_t number() {
    require(4);
    std::uint32_t value = 0;
    std::memcpy(&value, m_bytes.data() + m_at, 4);
    m_at += 4;
    return value;
  }

  /// A name and its terminating zero.
  std::string_view name() {
    const char* first = reinterpret_cast<const char*>(m_bytes.data()) + m_at;
    const std::string_view searched(first, std::min(left(), longest_name + 1));
    const std::size_t length = searched.find('\0');
    if (length == std::string_view::npos)
      fail("a name in the EXR header does not end within 255 bytes");
    m_at += length + 1;
    return searched.substr(0, length);
  }

  void skip(std::uint64_t count) {
    require(count);
    m_at += count;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw_input_error(m_file.path(), message, m_at);
  }

private:
  void require(std::uint64_t count) const {
    if (count > left())
      fail(m_bytes.size() == m_file.bytes().size() ? "the file ends within the EXR header"
                                                   : "an attribute ends too early");
  }

  const InputFile& m_file;
  std::span<const std::byte> m_bytes;
  std::size_t m_at;
};

/// A chlist: names, each with its type, a flag, three reserved bytes and two sampling rates.
void check_channels(Walker& value) {
  int count = 0;
  while (!value.name().empty()) {
    if (value.number() > 2)
      value.fail("a channel is neither of half, float nor unsigned values");
    value.skip(4);
    for (int axis = 0; axis < 2; ++axis)
      if (const std::uint32_t sampling = value.number(); sampling < 1 || sampling > 1024)
        value.fail("a channel's sampling rate is not from 1 to 1024");
    if (++count > most_channels)
      value.fail("has more than " + std::to_string(most_channels) + " channels");
  }
}

void check_preview(Walker& value) {
  const std::uint64_t width = value.number();
  const std::uint64_t height = value.number();
  if (width > value.left() || height > value.left() || 4 * width * height != value.left())
    value.fail("the preview image is not of its stated size");
  value.skip(value.left());
}

void check_string_vector(Walker& value) {
  while (value.left() > 0)
    value.skip(value.number());
}

/// Types OpenEXR does not know are kept as bytes and may be of any size.
void check_value(std::string_view type, Walker& value) {
  const auto fixed = fixed_sizes().find(type);
  if (fixed != fixed_sizes().end() && fixed->second != value.left())
    value.fail("an attribute of type " + std::string(type) + " has " +
               std::to_string(value.left()) + " bytes, must have " + std::to_string(fixed->second));
  if (type == "chlist")
    check_channels(value);
  else if (type == "preview")
    check_preview(value);
  else if (type == "stringvector")
    check_string_vector(value);
  else if (type != "floatvector" || value.left() % 4 == 0)
    value.skip(value.left());
  if (value.left() > 0)
    value.fail("an attribute of type " + std::string(type) + " is not of its stated size");
}

std::uint32_t read_version(const InputFile& file) {
  Walker walker(file, 0, file.bytes().size());
  if (file.bytes().size() < 8 || walker.number() != magic_number)
    throw_input_error(file.path(), "is no EXR image (the magic number 76 2f 31 01 is missing)", 0);
  const std::uint32_t version = walker.number();
  const std::uint32_t flags = version & ~0xffU;
  if ((version & 0xffU) != format_version ||
      (flags & ~(tiled_flag | long_names_flag | deep_flag | multipart_flag)) != 0)
    throw_input_error(file.path(), "is of an unknown EXR version, 2 is needed", 4);
  if ((flags & deep_flag) != 0)
    throw_input_error(file.path(), "is a deep EXR, an image of one value per pixel is needed", 4);
  if ((flags & multipart_flag) != 0)
    throw_input_error(file.path(), "is a multi-part EXR, a single image is needed", 4);
  return version;
}

void require_attributes(const std::set<std::string_view>& names, bool tiled,
                        const InputFile& file) {
  constexpr std::array<std::string_view, 9> required = {
      "channels",         "compression",        "dataWindow",        "displayWindow", "lineOrder",
      "pixelAspectRatio", "screenWindowCenter", "screenWindowWidth", "tiles"};
  for (const std::string_view name : required)
    if (!names.contains(name) && (tiled || name != "tiles"))
      throw_input_error(file.path(), "lacks the header attribute " + std::string(name) +
                                         ", which every EXR image has");
}

/// @return the offset of the first byte after the header
std::size_t check_attributes(const InputFile& file, bool tiled) {
  Walker walker(file, 8, file.bytes().size());
  std::set<std::string_view> names;
  for (auto name = walker.name(); !name.empty(); name = walker.name()) {
    if (!names.insert(name).second)
      walker.fail("the header attribute " + printable(std::string(name)) + " occurs twice");
    const std::string_view type = walker.name();
    const std::uint32_t size = walker.number();
    const std::size_t begin = walker.position();
    walker.skip(size);
    Walker value(file, begin, walker.position());
    check_value(type, value);
  }
  require_attributes(names, tiled, file);
  return walker.position();
}

} // namespace

std::string printable(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return name;
}

Imf::Header read_exr_header(const InputFile& file) {
  auto version = static_cast<int>(read_version(file));
  const bool tiled = Imf::isTiled(version);
  const std::size_t header_end = check_attributes(file, tiled);
  return with_input_errors(file.path(), [&] {
    ExrInputStream stream(file);
    Imf::Header header;
    stream.seekg(8); // magic number and version are read
    header.readFrom(stream, version);
    if (stream.tellg() != header_end)
      throw_input_error(file.path(), "has a malformed header");
    header.sanityCheck(tiled);
    if (header.hasType() && header.type() != (tiled ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE))
      throw_input_error(file.path(), "is of type " + printable(header.type()) +
                                         ", a plain image of scanlines or tiles is needed");
    check_exr_chunks(file, header, tiled, header_end);
    return header;
  });
}

} // namespace haarlight::image
