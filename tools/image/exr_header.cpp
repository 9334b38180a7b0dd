#include <image/exr_header.h>

#include <image/exr_stream.h>

#include <OpenEXR/ImfVersion.h>

#include <cstring>
#include <span>

namespace haarlight::image {
namespace {

constexpr std::uint32_t magic_number = 20000630;
constexpr std::uint32_t deep_flag = 0x800;
constexpr std::uint32_t multipart_flag = 0x1000;

/// Steps through a header without believing it.
class Walker {
public:
  explicit Walker(const InputFile& file) : m_file(file), m_bytes(file.bytes()) {}

  std::uint32_t number() {
    require(4);
    std::uint32_t value = 0;
    std::memcpy(&value, m_bytes.data() + m_at, 4);
    m_at += 4;
    return value;
  }

  /// Length of a name, whose terminating zero is stepped over.
  std::size_t name() {
    const void* first = m_bytes.data() + m_at;
    const void* end = std::memchr(first, 0, m_bytes.size() - m_at);
    if (end == nullptr)
      fail("a header name has no end");
    const auto length =
        static_cast<std::size_t>(static_cast<const char*>(end) - static_cast<const char*>(first));
    m_at += length + 1;
    return length;
  }

  void skip(std::uint32_t count) {
    require(count);
    m_at += count;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw_input_error(m_file.path(), message, m_at);
  }

private:
  void require(std::uint64_t count) const {
    if (count > m_bytes.size() - m_at)
      fail("the file ends within the EXR header");
  }

  const InputFile& m_file;
  std::span<const std::byte> m_bytes;
  std::size_t m_at = 0;
};

/// @return the file's version field
int walk_through_header(const InputFile& file) {
  Walker walker(file);
  if (file.bytes().size() < 8 || walker.number() != magic_number)
    throw_input_error(file.path(), "is no EXR image (the magic number 76 2f 31 01 is missing)", 0);
  const std::uint32_t version = walker.number();
  if ((version & 0xffU) != 2)
    throw_input_error(file.path(), "is of an unknown EXR version, 2 is needed", 4);
  if ((version & (deep_flag | multipart_flag)) != 0)
    throw_input_error(file.path(), "is a deep or multi-part EXR, a single image is needed", 4);
  while (walker.name() > 0) {
    walker.name(); // of the type
    walker.skip(walker.number());
  }
  return static_cast<int>(version);
}

/// Tiles have an entry of 8 bytes each in a table, lines one for every 256 at least.
void check_table(const Imf::Header& header, bool tiled, const InputFile& file) {
  const Imath::Box2i& window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  const auto blocks = [](std::int64_t pixels, std::int64_t side) {
    return (pixels + side - 1) / side;
  };
  std::int64_t entries = blocks(height, 256);
  if (tiled)
    entries = blocks(width, header.tileDescription().xSize) *
              blocks(height, header.tileDescription().ySize);
  if (entries > static_cast<std::int64_t>(file.bytes().size() / 8))
    throw_input_error(file.path(), "is truncated: too short for its " + std::to_string(width) +
                                       " x " + std::to_string(height) + " pixels");
}

} // namespace

Imf::Header read_exr_header(const InputFile& file) {
  int version = walk_through_header(file);
  return with_input_errors(file.path(), [&] {
    ExrInputStream stream(file);
    Imf::Header header;
    stream.seekg(8); // magic number and version are read
    header.readFrom(stream, version);
    header.sanityCheck(Imf::isTiled(version));
    check_table(header, Imf::isTiled(version), file);
    return header;
  });
}

} // namespace haarlight::image
