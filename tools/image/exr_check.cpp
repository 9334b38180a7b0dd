#include <image/exr_check.h>

#include <image/exr_io.h>

#include <wavelet/base/error.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfVersion.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <vector>

namespace haarlight::image {
namespace {

// The header: attributes and their sizes.

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

// The chunks: blocks of scanlines, or tiles.

/// Limits of a compression method.
struct Density {
  std::int64_t lines = 1;    ///< scanlines of a chunk
  std::int64_t overhead = 0; ///< bytes of every compressed chunk that hold no pixels
  std::int64_t ratio = 1;    ///< most bytes of pixels per compressed byte
};

/// Deflate codes at most 258 bytes in 2 bits: zlib states 1032 : 1.
constexpr std::int64_t deflate_ratio = 1032;

Density density_of(Imf::Compression compression) {
  switch (compression) {
  case Imf::NO_COMPRESSION:
    return {1, 0, 1};
  case Imf::RLE_COMPRESSION:
    return {1, 0, 64}; // runs of 128 bytes in 2
  case Imf::ZIPS_COMPRESSION:
    return {1, 0, deflate_ratio};
  case Imf::ZIP_COMPRESSION:
    return {16, 0, deflate_ratio};
  case Imf::PIZ_COMPRESSION:
    return {32, 0, 512}; // Huffman codes of runs: 256 values of 16 bits in 10 bits, 410 : 1
  case Imf::PXR24_COMPRESSION:
    return {16, 0, 2 * deflate_ratio}; // floats cut to 24 bits, then deflated
  case Imf::B44_COMPRESSION:
  case Imf::B44A_COMPRESSION:
    return {32, 0, 11}; // 16 halves in 3 bytes
  case Imf::DWAA_COMPRESSION:
    return {32, 88, 128 * deflate_ratio}; // 64 floats by one coefficient of 16 bits, then deflated
  case Imf::DWAB_COMPRESSION:
    return {256, 88, 128 * deflate_ratio};
  default:
    return {};
  }
}

std::int64_t divide_up(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }
std::int64_t divide_down(std::int64_t a, std::int64_t b) {
  return a >= 0 ? a / b : -divide_up(-a, b);
}

/// Multiples of `step` from `low` to `high`.
std::int64_t samples(std::int64_t low, std::int64_t high, std::int64_t step) {
  return divide_down(high, step) - divide_down(low - 1, step);
}

struct Window {
  std::int64_t x0, y0, x1, y1; ///< inclusive

  std::int64_t width() const { return x1 - x0 + 1; }
  std::int64_t height() const { return y1 - y0 + 1; }
};

std::string size_text(const Window& window) {
  return std::to_string(window.width()) + " x " + std::to_string(window.height()) + " pixels";
}

class ChunkChecker {
public:
  ChunkChecker(const InputFile& file, const Imf::Header& header, std::uint64_t table)
      : m_file(file), m_header(header), m_table(table), m_size(file.bytes().size()),
        m_density(density_of(header.compression())) {
    const Imath::Box2i& box = header.dataWindow();
    m_window = {box.min.x, box.min.y, box.max.x, box.max.y};
    if (m_window.width() < 1 || m_window.height() < 1 ||
        m_window.width() > most_exr_pixels / m_window.height())
      fail("is of " + size_text(m_window) + ", at most 2^28 in all are read");
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
      if (c.channel().xSampling == 1 && c.channel().ySampling == 1)
        m_bytes_per_pixel += value_bytes(c.channel());
      else
        m_subsampled.push_back(c.channel());
  }

  void check_lines() {
    const std::int64_t count = divide_up(m_window.height(), m_density.lines);
    require_table(count);
    for (std::int64_t i = 0; i < count; ++i) {
      Window block = m_window;
      block.y0 = m_window.y0 + i * m_density.lines;
      block.y1 = std::min(m_window.y1, block.y0 + m_density.lines - 1);
      const std::int32_t place[] = {static_cast<std::int32_t>(block.y0)};
      check_chunk(place, raw_bytes(block));
    }
  }

  void check_tiles() {
    const Imf::TileDescription& tiles = m_header.tileDescription();
    require_moderate_tiles(tiles);
    const std::vector<Level> levels = levels_of(tiles);
    std::int64_t count = 0;
    for (const Level& level : levels)
      count += divide_up(level.width, tiles.xSize) * divide_up(level.height, tiles.ySize);
    require_table(count);
    for (const Level& level : levels)
      check_level(level, tiles);
  }

private:
  struct Level {
    std::int32_t x, y;
    std::int64_t width, height;
  };

  [[noreturn]] void fail(const std::string& message) const {
    throw_input_error(m_file.path(), message);
  }

  static std::int64_t value_bytes(const Imf::Channel& channel) {
    return channel.type == Imf::HALF ? 2 : 4;
  }

  /// Bytes of a block's pixels before compression.
  std::int64_t raw_bytes(const Window& block) const {
    std::int64_t bytes = block.width() * block.height() * m_bytes_per_pixel;
    for (const Imf::Channel& channel : m_subsampled)
      bytes += samples(block.x0, block.x1, channel.xSampling) *
               samples(block.y0, block.y1, channel.ySampling) * value_bytes(channel);
    return bytes;
  }

  /// OpenEXR's buffers hold a whole tile of all channels, and RGB of a whole row of tiles, however
  /// little of them lies within the image.
  void require_moderate_tiles(const Imf::TileDescription& tiles) const {
    const std::int64_t image_bytes = raw_bytes(m_window);
    const auto moderate = [&](std::int64_t width, std::int64_t bytes_per_pixel, std::int64_t most) {
      const std::int64_t row = width * std::max<std::int64_t>(bytes_per_pixel, 1);
      return row <= std::max(4 * image_bytes, most) / std::int64_t{tiles.ySize};
    };
    if (tiles.xSize < 1 || tiles.ySize < 1 ||
        !moderate(tiles.xSize, m_bytes_per_pixel, std::int64_t{16} << 20) ||
        !moderate(m_window.width(), 3 * sizeof(float), std::int64_t{48} << 20))
      fail("has tiles of " + std::to_string(tiles.xSize) + " x " + std::to_string(tiles.ySize) +
           " pixels, too large for an image of " + size_text(m_window));
  }

  void require_table(std::int64_t count) {
    if (static_cast<std::uint64_t>(count) > (m_size - m_table) / 8)
      fail("is truncated: too short for its " + size_text(m_window));
    if (m_header.hasChunkCount() && m_header.chunkCount() != count)
      fail("has a chunkCount of " + std::to_string(m_header.chunkCount()) + ", must be " +
           std::to_string(count));
    m_chunks = m_table + 8 * static_cast<std::uint64_t>(count);
    m_left = m_size - m_chunks;
  }

  template <class T>
  T number_at(std::uint64_t offset) const {
    T value{};
    std::memcpy(&value, m_file.bytes().data() + offset, sizeof value);
    return value;
  }

  /// Checks the chunk of the next entry of the table.
  /// @param place the coordinates at its head
  void check_chunk(std::span<const std::int32_t> place, std::int64_t raw) {
    const auto offset = number_at<std::uint64_t>(m_table + 8 * m_index);
    const std::string name = "chunk " + std::to_string(m_index++);
    if (offset == 0)
      fail("is truncated: pixels are missing (" + name + ")");
    const std::uint64_t head = 4 * (place.size() + 1);
    if (offset < m_chunks || offset > m_size || head > m_size - offset)
      fail(name + " lies outside of the file");
    for (std::size_t i = 0; i < place.size(); ++i)
      if (number_at<std::int32_t>(offset + 4 * i) != place[i])
        throw_input_error(m_file.path(), name + " is of another place in the image", offset);
    const std::int64_t size = number_at<std::int32_t>(offset + head - 4);
    if (size < 0 || static_cast<std::uint64_t>(size) > m_size - offset - head)
      throw_input_error(m_file.path(), name + " does not end within the file", offset);
    check_density(name, size, raw, offset);
    // All chunks together cannot be longer than the file, so no two of them overlap much.
    const std::uint64_t taken = head + static_cast<std::uint64_t>(size);
    if (taken > m_left)
      throw_input_error(m_file.path(), name + " overlaps others", offset);
    m_left -= taken;
  }

  void check_density(const std::string& name, std::int64_t size, std::int64_t raw,
                     std::uint64_t offset) const {
    const bool stored = m_header.compression() == Imf::NO_COMPRESSION || size == raw;
    const bool fits = stored ? size == raw
                             : size < raw && size > m_density.overhead &&
                                   raw / m_density.ratio <= size - m_density.overhead;
    if (!fits || raw > INT32_MAX)
      throw_input_error(m_file.path(),
                        name + " has " + std::to_string(size) + " bytes, which cannot hold its " +
                            std::to_string(raw) + " bytes of pixels",
                        offset);
  }

  std::vector<Level> levels_of(const Imf::TileDescription& tiles) const {
    const auto extent = [&](std::int64_t full, int level) {
      const std::int64_t rounded = tiles.roundingMode == Imf::ROUND_UP
                                       ? divide_up(full, std::int64_t{1} << level)
                                       : full >> level;
      return std::max<std::int64_t>(rounded, 1);
    };
    const auto count = [&](std::int64_t full) {
      const auto value = static_cast<std::uint64_t>(full);
      return static_cast<int>(tiles.roundingMode == Imf::ROUND_UP ? std::bit_width(value - 1) + 1
                                                                  : std::bit_width(value));
    };
    const std::int64_t width = m_window.width();
    const std::int64_t height = m_window.height();
    std::vector<Level> levels;
    if (tiles.mode == Imf::RIPMAP_LEVELS) {
      for (int y = 0; y < count(height); ++y)
        for (int x = 0; x < count(width); ++x)
          levels.push_back({x, y, extent(width, x), extent(height, y)});
      return levels;
    }
    const int last = tiles.mode == Imf::MIPMAP_LEVELS ? count(std::max(width, height)) : 1;
    for (int l = 0; l < last; ++l)
      levels.push_back({l, l, extent(width, l), extent(height, l)});
    return levels;
  }

  void check_level(const Level& level, const Imf::TileDescription& tiles) {
    const auto xs = static_cast<std::int64_t>(tiles.xSize);
    const auto ys = static_cast<std::int64_t>(tiles.ySize);
    for (std::int64_t y = 0; y * ys < level.height; ++y)
      for (std::int64_t x = 0; x * xs < level.width; ++x) {
        const std::int32_t place[] = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                                      level.x, level.y};
        check_chunk(place, std::min(xs, level.width - x * xs) *
                               std::min(ys, level.height - y * ys) * m_bytes_per_pixel);
      }
  }

  const InputFile& m_file;
  const Imf::Header& m_header;
  std::uint64_t m_table;
  std::uint64_t m_size;
  Density m_density;
  Window m_window{};
  std::int64_t m_bytes_per_pixel = 0; ///< of the channels that are not subsampled
  std::vector<Imf::Channel> m_subsampled;
  std::uint64_t m_chunks = 0; ///< offset of the first byte after the table
  std::uint64_t m_left = 0;   ///< bytes that no chunk has taken
  std::uint64_t m_index = 0;
};

/// Checks the table of chunks and every chunk.
/// @param header one whose sanityCheck() has passed
/// @param table  offset of the table
/// @throws Error(Input)
void check_exr_chunks(const InputFile& file, const Imf::Header& header, bool tiled,
                      std::uint64_t table) {
  ChunkChecker checker(file, header, table);
  if (tiled)
    checker.check_tiles();
  else
    checker.check_lines();
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
