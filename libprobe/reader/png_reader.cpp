// PNG files, by libpng.

#include "decoder.h"
#include "encoding.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <initializer_list>

namespace haarlight::probe::reader {
namespace {

constexpr int longest_side = 1 << 17;

/// Raw bytes that deflate can pack into one.
constexpr std::uint64_t deflate_ratio = 1032;

/// A file that is being read. libpng returns from an error by longjmp to `target`; frames skipped
/// by a jump have no destructors.
class PngFile {
public:
  explicit PngFile(std::span<const std::byte> bytes) : m_bytes(bytes) {
    png = ::png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    info = ::png_create_info_struct(png);
    ::png_set_read_fn(png, this, on_read);
    ::png_set_user_limits(png, longest_side, longest_side);
    ::png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_ALWAYS,
                                  reinterpret_cast<const png_byte*>("cICP"), 1);
  }
  ~PngFile() { ::png_destroy_read_struct(&png, &info, nullptr); }
  PngFile(const PngFile&) = delete;
  PngFile& operator=(const PngFile&) = delete;

  /// @throws DecodeError if libpng reports an error
  void read_header() {
    if (setjmp(m_target) != 0)
      fail();
    ::png_read_info(png, info);
  }

  /// Sets the conversion to 8 or 16 bits of grey or RGB, with alpha if there is transparency.
  void expand() {
    if (setjmp(m_target) != 0)
      fail();
    ::png_set_expand(png);
    if constexpr (std::endian::native == std::endian::little)
      ::png_set_swap(png);
    ::png_set_interlace_handling(png);
    ::png_read_update_info(png, info);
  }

  void read_rows(png_bytepp rows) {
    if (setjmp(m_target) != 0)
      fail();
    ::png_read_image(png, rows);
    ::png_read_end(png, info);
  }

  /// The warning of libpng; empty if none.
  const std::string& warning() const { return m_warning; }

  png_structp png = nullptr;
  png_infop info = nullptr;

private:
  [[noreturn]] void fail() const { throw DecodeError("cannot be decoded: libpng: " + m_error); }

  [[noreturn]] static void on_error(png_structp png, png_const_charp message) {
    auto* file = static_cast<PngFile*>(::png_get_error_ptr(png));
    file->m_error = message;
    std::longjmp(file->m_target, 1);
  }
  static void on_warning(png_structp png, png_const_charp message) {
    auto* file = static_cast<PngFile*>(::png_get_error_ptr(png));
    if (file->m_warning.empty())
      file->m_warning = message;
  }
  static void on_read(png_structp png, png_bytep to, std::size_t count) {
    auto* file = static_cast<PngFile*>(::png_get_io_ptr(png));
    if (count > file->m_bytes.size() - file->m_position)
      ::png_error(png, "the file is cut short");
    std::memcpy(to, file->m_bytes.data() + file->m_position, count);
    file->m_position += count;
  }

  std::span<const std::byte> m_bytes;
  std::size_t m_position = 0;
  std::string m_error;
  std::string m_warning;
  std::jmp_buf m_target{};
};

std::span<const std::byte> as_bytes(const void* bytes, std::size_t count) {
  return {static_cast<const std::byte*>(bytes), count};
}

/// Coding-independent code points: nothing if the file has none.
std::optional<Encoding> cicp_encoding(const PngFile& file) {
  png_unknown_chunkp chunks = nullptr;
  const int count = ::png_get_unknown_chunks(file.png, file.info, &chunks);
  for (int i = 0; i < count; ++i) {
    if (std::memcmp(chunks[i].name, "cICP", 4) != 0)
      continue;
    const auto is = [&](std::initializer_list<int> code) {
      return chunks[i].size == 4 && std::equal(code.begin(), code.end(), chunks[i].data);
    };
    if (is({1, 13, 0, 1}))
      return srgb_encoding("values were decoded as sRGB, as its cICP chunk states");
    if (is({1, 8, 0, 1}))
      return linear_encoding("values are linear, as its cICP chunk states");
    throw DecodeError("has a cICP chunk for another colour space than sRGB or linear Rec. 709");
  }
  return std::nullopt;
}

/// By the precedence of the PNG specification: cICP, iCCP, sRGB, gAMA and cHRM.
Encoding encoding_of(const PngFile& file) {
  if (auto encoding = cicp_encoding(file))
    return *encoding;
  png_charp name = nullptr;
  png_bytep profile = nullptr;
  png_uint_32 length = 0;
  int compression = 0;
  if (::png_get_iCCP(file.png, file.info, &name, &compression, &profile, &length) != 0)
    return icc_encoding(as_bytes(profile, length));
  int intent = 0;
  if (::png_get_sRGB(file.png, file.info, &intent) != 0)
    return srgb_encoding("values were decoded as sRGB, as its sRGB chunk states");
  double gamma = 0;
  const bool has_gamma = ::png_get_gAMA(file.png, file.info, &gamma) != 0 && gamma > 0;
  Encoding encoding =
      has_gamma && gamma == 1 ? linear_encoding("values are linear, as its gAMA chunk states")
      : has_gamma ? power_encoding(1 / gamma, "values were decoded by the gamma of its gAMA chunk")
                  : srgb_encoding("values were decoded as sRGB; the file states no encoding");
  double c[8] = {};
  if (::png_get_cHRM(file.png, file.info, &c[0], &c[1], &c[2], &c[3], &c[4], &c[5], &c[6], &c[7]) !=
      0)
    set_primaries(encoding, {{c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}, {c[0], c[1]}});
  if (encoding.matrix)
    encoding.note += ", colours converted from the primaries of its cHRM chunk";
  return encoding;
}

unsigned orientation_of(const PngFile& file) {
  png_bytep exif = nullptr;
  png_uint_32 length = 0;
  if (::png_get_eXIf_1(file.png, file.info, &length, &exif) == 0)
    return 1;
  return exif_orientation(as_bytes(exif, length));
}

} // namespace

DecodedImage read_png(const Task& task) {
  reject_choice(task.choice);
  PngFile file(task.bytes);
  file.read_header();
  const std::uint64_t width = ::png_get_image_width(file.png, file.info);
  const std::uint64_t height = ::png_get_image_height(file.png, file.info);
  check_pixels(width, height);
  check_file_size(task, (::png_get_rowbytes(file.png, file.info) + 1) * height, deflate_ratio);
  file.expand();
  const std::size_t row_bytes = ::png_get_rowbytes(file.png, file.info);
  allow_memory(row_bytes * height + 2 * 12 * width * height);
  std::vector<png_byte> samples(row_bytes * height);
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y)
    rows[y] = samples.data() + y * row_bytes;
  file.read_rows(rows.data());

  const int channels = ::png_get_channels(file.png, file.info);
  const SampleLayout layout{.samples = channels,
                            .colours = channels >= 3 ? 3 : 1,
                            .alpha = channels % 2 == 0 ? Alpha::Unassociated : Alpha::None};
  RowConverter converter(encoding_of(file), layout);
  DecodedImage picture;
  picture.image = Image(static_cast<int>(width), static_cast<int>(height));
  const bool wide = ::png_get_bit_depth(file.png, file.info) == 16;
  for (std::size_t y = 0; y < height; ++y) {
    float* to = picture.image.rgb.data() + 3 * y * width;
    if (wide)
      converter.convert(reinterpret_cast<const std::uint16_t*>(rows[y]), picture.image.width, to);
    else
      converter.convert(rows[y], picture.image.width, to);
  }
  picture.notes = converter.notes();
  if (!file.warning().empty())
    picture.notes.push_back("libpng warns: " + file.warning());
  picture.image = upright(std::move(picture.image), orientation_of(file));
  return picture;
}

} // namespace haarlight::probe::reader
