// JPEG files, by libjpeg.

#include "decoder.h"
#include "encoding.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include <jerror.h>
#include <jpeglib.h>

namespace haarlight::probe::reader {
namespace {

/// Pixels of one byte of Huffman-coded data at most: a block of 8x8 takes one bit or more.
constexpr std::uint64_t huffman_ratio = 512;

/// A file that is being read. libjpeg returns from an error by longjmp to `target`; frames skipped
/// by a jump have no destructors.
class JpegFile {
public:
  explicit JpegFile(std::span<const std::byte> bytes) : m_bytes(bytes) {
    info.err = ::jpeg_std_error(&m_errors);
    m_errors.error_exit = on_error;
    m_errors.emit_message = on_message;
    info.client_data = this;
    ::jpeg_create_decompress(&info);
  }
  ~JpegFile() { ::jpeg_destroy_decompress(&info); }
  JpegFile(const JpegFile&) = delete;
  JpegFile& operator=(const JpegFile&) = delete;

  /// @throws DecodeError if libjpeg reports an error or damaged data, as the others do
  void read_header() {
    if (setjmp(m_target) != 0)
      fail();
    ::jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(m_bytes.data()), m_bytes.size());
    constexpr unsigned longest_marker = 0xffff;
    ::jpeg_save_markers(&info, JPEG_APP0 + 1, longest_marker);
    ::jpeg_save_markers(&info, JPEG_APP0 + 2, longest_marker);
    ::jpeg_read_header(&info, TRUE);
  }

  void start() {
    if (setjmp(m_target) != 0)
      fail();
    info.out_color_space = info.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
    info.dct_method = JDCT_ISLOW;
    ::jpeg_start_decompress(&info);
  }

  void read_row(JSAMPROW row) {
    if (setjmp(m_target) != 0)
      fail();
    ::jpeg_read_scanlines(&info, &row, 1);
  }

  jpeg_decompress_struct info{};

private:
  [[noreturn]] void fail() {
    char message[JMSG_LENGTH_MAX];
    m_errors.format_message(reinterpret_cast<j_common_ptr>(&info), message);
    throw DecodeError("cannot be decoded: libjpeg: " + std::string(message));
  }

  [[noreturn]] static void on_error(j_common_ptr common) {
    std::longjmp(static_cast<JpegFile*>(common->client_data)->m_target, 1);
  }
  /// libjpeg fills the rest of a damaged image with grey; that is an error here.
  static void on_message(j_common_ptr common, int level) {
    const int code = common->err->msg_code;
    if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER ||
                      code == JWRN_HUFF_BAD_CODE || code == JWRN_MUST_RESYNC))
      on_error(common);
  }

  std::span<const std::byte> m_bytes;
  jpeg_error_mgr m_errors{};
  std::jmp_buf m_target{};
};

unsigned orientation_of(const jpeg_decompress_struct& info) {
  constexpr std::string_view signature("Exif\0\0", 6);
  for (const jpeg_marker_struct* m = info.marker_list; m != nullptr; m = m->next) {
    const std::string_view text(reinterpret_cast<const char*>(m->data), m->data_length);
    if (m->marker == JPEG_APP0 + 1 && text.starts_with(signature))
      return exif_orientation({reinterpret_cast<const std::byte*>(m->data) + signature.size(),
                               m->data_length - signature.size()});
  }
  return 1;
}

Encoding encoding_of(JpegFile& file) {
  JOCTET* profile = nullptr;
  unsigned length = 0;
  if (::jpeg_read_icc_profile(&file.info, &profile, &length) == 0)
    return srgb_encoding("values were decoded as sRGB");
  const std::vector<JOCTET> bytes(profile, profile + length);
  std::free(profile);
  return icc_encoding(std::as_bytes(std::span(bytes)));
}

} // namespace

DecodedImage read_jpeg(const Task& task) {
  reject_choice(task.choice);
  JpegFile file(task.bytes);
  file.read_header();
  const std::uint64_t width = file.info.image_width;
  const std::uint64_t height = file.info.image_height;
  check_pixels(width, height);
  if (file.info.arith_code != 0)
    throw DecodeError("is coded arithmetically, only Huffman codes are read");
  check_file_size(task, width * height, huffman_ratio);
  if (file.info.num_components != 1 && file.info.num_components != 3)
    throw DecodeError("has " + std::to_string(file.info.num_components) +
                      " colour components, 1 (grey) or 3 are read");
  Encoding encoding = encoding_of(file);
  constexpr std::uint64_t coefficients_of_pixel = 3 * sizeof(JCOEF); // of progressive files
  allow_memory((coefficients_of_pixel + 2 * 12) * width * height);
  file.start();
  const int channels = file.info.output_components;
  RowConverter converter(std::move(encoding), {.samples = channels, .colours = channels});
  DecodedImage picture;
  picture.image = Image(static_cast<int>(width), static_cast<int>(height));
  std::vector<JSAMPLE> row(width * static_cast<std::size_t>(channels));
  for (int y = 0; y < picture.image.height; ++y) {
    file.read_row(row.data());
    converter.convert(row.data(), picture.image.width,
                      picture.image.rgb.data() + picture.image.offset(0, y));
  }
  picture.notes = converter.notes();
  picture.image = upright(std::move(picture.image), orientation_of(file.info));
  return picture;
}

} // namespace haarlight::probe::reader
