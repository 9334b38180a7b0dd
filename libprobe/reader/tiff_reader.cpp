// TIFF files, by libtiff.

#include "decoder.h"
#include "encoding.h"

#include <OpenEXR/ImfRgba.h>

#include <algorithm>
#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

#include <tiffio.h>

namespace haarlight::probe::reader {
namespace {

/// The first error that libtiff reported.
std::string& tiff_error() {
  static std::string error;
  return error;
}

void on_error(const char* module, const char* format, va_list arguments) {
  if (!tiff_error().empty())
    return;
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  tiff_error() = (module != nullptr ? std::string(module) + ": " : "") + text;
}

[[noreturn]] void refuse_damaged() {
  throw DecodeError("cannot be decoded: libtiff: " +
                    (tiff_error().empty() ? "the file is damaged" : tiff_error()));
}

/// A file in memory, in the form that TIFFClientOpen wants.
struct MemoryFile {
  std::span<const std::byte> bytes;
  std::uint64_t position = 0;

  static tmsize_t read(thandle_t handle, void* to, tmsize_t count) {
    auto* file = static_cast<MemoryFile*>(handle);
    const std::uint64_t size = file->bytes.size();
    const std::uint64_t left = file->position < size ? size - file->position : 0;
    const std::uint64_t got = std::min(left, static_cast<std::uint64_t>(count));
    std::memcpy(to, file->bytes.data() + (got > 0 ? file->position : 0), got);
    file->position += got;
    return static_cast<tmsize_t>(got);
  }
  static tmsize_t write(thandle_t, void*, tmsize_t) { return 0; }
  static toff_t seek(thandle_t handle, toff_t offset, int origin) {
    auto* file = static_cast<MemoryFile*>(handle);
    const std::uint64_t base = origin == SEEK_SET   ? 0
                               : origin == SEEK_CUR ? file->position
                                                    : file->bytes.size();
    return file->position = base + offset;
  }
  static int close(thandle_t) { return 0; }
  static toff_t size(thandle_t handle) { return static_cast<MemoryFile*>(handle)->bytes.size(); }
};

struct CloseTiff {
  void operator()(TIFF* tiff) const { ::TIFFClose(tiff); }
};
using TiffPointer = std::unique_ptr<TIFF, CloseTiff>;

/// The tags that matter of the chosen directory.
struct TiffHeader {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint16_t bits = 1;
  std::uint16_t samples = 1;
  std::uint16_t format = SAMPLEFORMAT_UINT;
  std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
  std::uint16_t compression = COMPRESSION_NONE;
  std::uint16_t planar = PLANARCONFIG_CONTIG;
  std::uint16_t orientation = ORIENTATION_TOPLEFT;

  std::size_t sample_bytes() const { return bits / 8; }
  std::size_t row_bytes() const { return std::size_t{width} * samples * sample_bytes(); }
};

TiffHeader read_header(TIFF* tiff) {
  TiffHeader h;
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_IMAGEWIDTH, &h.width);
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_IMAGELENGTH, &h.height);
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &h.bits);
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &h.samples);
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &h.format);
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &h.compression);
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &h.planar);
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &h.orientation);
  if (::TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &h.photometric) == 0)
    h.photometric = h.samples >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK;
  return h;
}

/// Numbers of the pages that are images of their own: no thumbnails, mip levels or masks.
std::vector<unsigned> find_pages(TIFF* tiff) {
  constexpr unsigned most_pages = 10000;
  std::vector<unsigned> pages;
  unsigned number = 0;
  do {
    std::uint32_t type = 0;
    ::TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &type);
    if ((type & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) == 0)
      pages.push_back(number);
  } while (++number < most_pages && ::TIFFReadDirectory(tiff) != 0);
  if (!tiff_error().empty())
    refuse_damaged();
  return pages;
}

void choose_page(TIFF* tiff, const ImageChoice& choice) {
  if (!choice.layer.empty())
    throw DecodeError("has no layers, its pages are chosen as parts");
  const std::vector<unsigned> pages = find_pages(tiff);
  const std::string count = std::to_string(pages.size());
  unsigned page = pages.empty() ? 0 : pages.front();
  if (!choice.part.empty()) {
    const char* end = choice.part.data() + choice.part.size();
    const auto parsed = std::from_chars(choice.part.data(), end, page);
    if (parsed.ec != std::errc{} || parsed.ptr != end ||
        std::find(pages.begin(), pages.end(), page) == pages.end())
      throw DecodeError("has no page '" + choice.part + "'; it has " + count +
                        " images, counted from 0");
  } else if (pages.size() != 1) {
    throw DecodeError("has " + count + " pages that are images, choose one as its part");
  }
  if (::TIFFSetDirectory(tiff, static_cast<tdir_t>(page)) == 0)
    refuse_damaged();
}

/// Largest number of raw bytes per byte of the file: runs of 127, LZW codes of 12 bits for strings
/// of up to 3837 bytes, the limit of deflate; 2^20 where there is no bound worth stating.
std::uint64_t largest_ratio(std::uint16_t compression) {
  switch (compression) {
  case COMPRESSION_NONE:
    return 1;
  case COMPRESSION_PACKBITS:
    return 64;
  case COMPRESSION_LZW:
    return 2560;
  case COMPRESSION_DEFLATE:
  case COMPRESSION_ADOBE_DEFLATE:
    return 1032;
  case COMPRESSION_SGILOG:
    return 128;
  case COMPRESSION_JPEG:
    return std::uint64_t{3} * 512;
  default:
    return std::uint64_t{1} << 20;
  }
}

/// Samples of the whole image, interleaved, as native-endian values.
std::vector<std::uint8_t> read_strips(TIFF* tiff, const TiffHeader& h) {
  std::vector<std::uint8_t> result(h.row_bytes() * h.height);
  const bool separate = h.planar == PLANARCONFIG_SEPARATE;
  std::vector<std::uint8_t> line(static_cast<std::size_t>(::TIFFScanlineSize64(tiff)));
  const std::size_t bytes = h.sample_bytes();
  if (line.size() < (separate ? h.width * bytes : h.row_bytes()))
    refuse_damaged();
  const std::uint16_t planes = separate ? h.samples : std::uint16_t{1};
  for (std::uint16_t plane = 0; plane < planes; ++plane)
    for (std::uint32_t y = 0; y < h.height; ++y) {
      if (::TIFFReadScanline(tiff, line.data(), y, plane) < 0)
        refuse_damaged();
      std::uint8_t* row = result.data() + y * h.row_bytes();
      if (!separate)
        std::copy_n(line.data(), h.row_bytes(), row);
      else
        for (std::size_t x = 0; x < h.width; ++x)
          std::copy_n(line.data() + x * bytes, bytes, row + (x * h.samples + plane) * bytes);
    }
  return result;
}

std::vector<std::uint8_t> read_tiles(TIFF* tiff, const TiffHeader& h) {
  std::vector<std::uint8_t> result(h.row_bytes() * h.height);
  const bool separate = h.planar == PLANARCONFIG_SEPARATE;
  std::uint32_t tile_width = 0;
  std::uint32_t tile_height = 0;
  ::TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile_width);
  ::TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile_height);
  check_pixels(tile_width, tile_height);
  const std::size_t bytes = h.sample_bytes() * (separate ? 1 : h.samples); // of a pixel in a tile
  const std::size_t pixel = h.sample_bytes() * h.samples;
  std::vector<std::uint8_t> tile(static_cast<std::size_t>(::TIFFTileSize64(tiff)));
  if (tile.size() < std::size_t{tile_width} * tile_height * bytes)
    refuse_damaged();
  const std::uint16_t planes = separate ? h.samples : std::uint16_t{1};
  for (std::uint16_t plane = 0; plane < planes; ++plane)
    for (std::uint32_t y = 0; y < h.height; y += tile_height)
      for (std::uint32_t x = 0; x < h.width; x += tile_width) {
        if (::TIFFReadTile(tiff, tile.data(), x, y, 0, plane) < 0)
          refuse_damaged();
        const std::uint32_t columns = std::min(tile_width, h.width - x);
        const std::uint32_t rows = std::min(tile_height, h.height - y);
        for (std::uint32_t j = 0; j < rows; ++j)
          for (std::uint32_t i = 0; i < columns; ++i)
            std::copy_n(tile.data() + (std::size_t{j} * tile_width + i) * bytes, bytes,
                        result.data() + (y + j) * h.row_bytes() + (x + i) * pixel +
                            plane * h.sample_bytes());
      }
  return result;
}

bool get_array(TIFF* tiff, std::uint32_t tag, std::size_t count, std::vector<double>& values) {
  float* found = nullptr;
  if (::TIFFGetField(tiff, tag, &found) == 0 || found == nullptr)
    return false;
  values.assign(found, found + count);
  return true;
}

/// PrimaryChromaticities and WhitePoint.
void obey_primaries(TIFF* tiff, Encoding& encoding) {
  std::vector<double> p;
  std::vector<double> white = {0.3127, 0.3290};
  if (!get_array(tiff, TIFFTAG_PRIMARYCHROMATICITIES, 6, p))
    return;
  get_array(tiff, TIFFTAG_WHITEPOINT, 2, white);
  set_primaries(encoding, {{p[0], p[1]}, {p[2], p[3]}, {p[4], p[5]}, {white[0], white[1]}});
  if (encoding.matrix)
    encoding.note += ", colours converted from its PrimaryChromaticities";
}

Encoding encoding_of(TIFF* tiff, const TiffHeader& h) {
  const bool real = h.format == SAMPLEFORMAT_IEEEFP;
  std::uint32_t length = 0;
  void* profile = nullptr;
  if (::TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &length, &profile) != 0) {
    Encoding encoding = icc_encoding({static_cast<const std::byte*>(profile), length});
    if (real && encoding.curves[0])
      throw DecodeError("has floating-point values and an ICC profile whose curve is not linear");
    return encoding;
  }
  std::uint16_t* curves[3] = {};
  if (!real &&
      ::TIFFGetField(tiff, TIFFTAG_TRANSFERFUNCTION, &curves[0], &curves[1], &curves[2]) != 0)
    throw DecodeError("has a TransferFunction, which is not read; convert it to sRGB or float");
  Encoding encoding =
      real ? linear_encoding("")
      : h.bits == 8
          ? srgb_encoding("values of 8 bits were decoded as sRGB; the file states no encoding")
          : linear_encoding("values of " + std::to_string(h.bits) +
                            " bits were taken as linear; the file states no encoding");
  obey_primaries(tiff, encoding);
  return encoding;
}

SampleLayout layout_of(TIFF* tiff, const TiffHeader& h) {
  SampleLayout layout{.samples = h.samples,
                      .colours = h.photometric == PHOTOMETRIC_RGB ? 3 : 1,
                      .inverted = h.photometric == PHOTOMETRIC_MINISWHITE};
  if (h.samples < layout.colours)
    throw DecodeError("has " + std::to_string(h.samples) + " samples per pixel, RGB takes 3");
  std::uint16_t count = 0;
  std::uint16_t* types = nullptr;
  ::TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &count, &types);
  if (h.samples > layout.colours && count > 0 && types != nullptr)
    layout.alpha = types[0] == EXTRASAMPLE_UNASSALPHA   ? Alpha::Unassociated
                   : types[0] == EXTRASAMPLE_ASSOCALPHA ? Alpha::Associated
                                                        : Alpha::None;
  return layout;
}

/// Floats of 16 or 64 bits made floats of 32.
template <class T>
std::vector<float> floats_of(const std::vector<std::uint8_t>& raw) {
  std::vector<float> values(raw.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value{};
    std::memcpy(&value, raw.data() + i * sizeof(T), sizeof(T));
    values[i] = static_cast<float>(value);
  }
  return values;
}

template <class T>
void convert_rows(RowConverter& converter, const T* samples, const TiffHeader& h, Image& image) {
  for (int y = 0; y < image.height; ++y)
    converter.convert(samples + std::size_t{h.width} * h.samples * static_cast<std::size_t>(y),
                      image.width, image.rgb.data() + image.offset(0, y));
}

/// Grey and RGB of whole bytes.
DecodedImage read_samples(TIFF* tiff, const TiffHeader& h) {
  RowConverter converter(encoding_of(tiff, h), layout_of(tiff, h));
  const auto raw = ::TIFFIsTiled(tiff) != 0 ? read_tiles(tiff, h) : read_strips(tiff, h);
  DecodedImage picture;
  picture.image = Image(static_cast<int>(h.width), static_cast<int>(h.height));
  if (h.format == SAMPLEFORMAT_IEEEFP && h.bits != 32)
    convert_rows(converter, (h.bits == 16 ? floats_of<half>(raw) : floats_of<double>(raw)).data(),
                 h, picture.image);
  else if (h.format == SAMPLEFORMAT_IEEEFP)
    convert_rows(converter, reinterpret_cast<const float*>(raw.data()), h, picture.image);
  else if (h.bits == 8)
    convert_rows(converter, raw.data(), h, picture.image);
  else if (h.bits == 16)
    convert_rows(converter, reinterpret_cast<const std::uint16_t*>(raw.data()), h, picture.image);
  else
    convert_rows(converter, reinterpret_cast<const std::uint32_t*>(raw.data()), h, picture.image);
  picture.notes = converter.notes();
  return picture;
}

/// LogLuv and LogL: CIE XYZ, or Y alone, as floats (G. Ward Larson, "LogLuv Encoding for
/// Full-Gamut, High-Dynamic Range Images", 1998).
DecodedImage read_log(TIFF* tiff, TiffHeader h) {
  ::TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
  h.samples = h.photometric == PHOTOMETRIC_LOGLUV ? 3 : 1;
  h.bits = 32;
  h.format = SAMPLEFORMAT_IEEEFP;
  h.planar = PLANARCONFIG_CONTIG;
  const auto raw = ::TIFFIsTiled(tiff) != 0 ? read_tiles(tiff, h) : read_strips(tiff, h);
  const std::vector<float> values = floats_of<float>(raw);
  DecodedImage picture;
  picture.image = Image(static_cast<int>(h.width), static_cast<int>(h.height));
  for (std::size_t i = 0; i < picture.image.rgb.size() / 3; ++i) {
    const float* v = values.data() + i * h.samples;
    Eigen::Map<Rgb> rgb(picture.image.rgb.data() + 3 * i);
    if (h.samples == 1)
      rgb.setConstant(v[0]);
    else
      rgb = convert_colour(rec709_from_xyz(), {v[0], v[1], v[2]}).cast<float>();
  }
  picture.notes.emplace_back("CIE XYZ was converted to Rec. 709, without chromatic adaptation");
  return picture;
}

/// Palettes, YCbCr and grey below 8 bits, which libtiff itself makes 8-bit RGB.
DecodedImage read_display(TIFF* tiff, const TiffHeader& h) {
  char message[1024] = {};
  if (::TIFFRGBAImageOK(tiff, message) == 0)
    throw DecodeError("cannot be decoded: libtiff: " + std::string(message));
  std::vector<std::uint32_t> raster(std::size_t{h.width} * h.height);
  if (::TIFFReadRGBAImageOriented(tiff, h.width, h.height, raster.data(), h.orientation, 1) == 0)
    refuse_damaged();
  Encoding encoding = srgb_encoding("values were decoded as sRGB");
  std::uint32_t length = 0;
  void* profile = nullptr;
  if (::TIFFGetField(tiff, TIFFTAG_ICCPROFILE, &length, &profile) != 0)
    encoding = icc_encoding({static_cast<const std::byte*>(profile), length});
  RowConverter converter(std::move(encoding), {.samples = 3, .colours = 3});
  DecodedImage picture;
  picture.image = Image(static_cast<int>(h.width), static_cast<int>(h.height));
  std::vector<std::uint8_t> row(std::size_t{3} * h.width);
  for (std::uint32_t y = 0; y < h.height; ++y) {
    for (std::size_t x = 0; x < h.width; ++x) {
      const std::uint32_t pixel = raster[std::size_t{y} * h.width + x];
      row[3 * x] = static_cast<std::uint8_t>(TIFFGetR(pixel));
      row[3 * x + 1] = static_cast<std::uint8_t>(TIFFGetG(pixel));
      row[3 * x + 2] = static_cast<std::uint8_t>(TIFFGetB(pixel));
    }
    converter.convert(row.data(), picture.image.width,
                      picture.image.rgb.data() + picture.image.offset(0, static_cast<int>(y)));
  }
  picture.notes = converter.notes();
  return picture;
}

bool has_plain_samples(const TiffHeader& h) {
  const bool photometric = h.photometric == PHOTOMETRIC_MINISBLACK ||
                           h.photometric == PHOTOMETRIC_MINISWHITE ||
                           h.photometric == PHOTOMETRIC_RGB;
  if (!photometric)
    return false;
  if (h.format == SAMPLEFORMAT_IEEEFP)
    return h.bits == 16 || h.bits == 32 || h.bits == 64;
  return (h.format == SAMPLEFORMAT_UINT || h.format == SAMPLEFORMAT_VOID) &&
         (h.bits == 8 || h.bits == 16 || h.bits == 32);
}

DecodedImage decode(TIFF* tiff, const TiffHeader& h) {
  if (h.photometric == PHOTOMETRIC_LOGLUV || h.photometric == PHOTOMETRIC_LOGL)
    return read_log(tiff, h);
  if (has_plain_samples(h))
    return read_samples(tiff, h);
  const bool small_grey =
      h.photometric == PHOTOMETRIC_MINISBLACK || h.photometric == PHOTOMETRIC_MINISWHITE;
  if (h.format == SAMPLEFORMAT_UINT && h.bits <= 8 &&
      (small_grey || h.photometric == PHOTOMETRIC_PALETTE || h.photometric == PHOTOMETRIC_YCBCR))
    return read_display(tiff, h);
  throw DecodeError(
      "has " + std::to_string(h.samples) + " samples of " + std::to_string(h.bits) +
      " bits (SampleFormat " + std::to_string(h.format) + ", Photometric " +
      std::to_string(h.photometric) +
      "); grey and RGB of 8, 16 or 32 bits or floats, palettes, YCbCr and LogLuv are read");
}

} // namespace

DecodedImage read_tiff(const Task& task) {
  ::TIFFSetErrorHandler(on_error);
  ::TIFFSetWarningHandler(nullptr);
  MemoryFile file{task.bytes};
  const TiffPointer tiff(::TIFFClientOpen("it", "rm", &file, MemoryFile::read, MemoryFile::write,
                                          MemoryFile::seek, MemoryFile::close, MemoryFile::size,
                                          nullptr, nullptr));
  if (!tiff)
    refuse_damaged();
  choose_page(tiff.get(), task.choice);
  const TiffHeader header = read_header(tiff.get());
  check_pixels(header.width, header.height);
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
  const std::uint64_t raw = pixels * header.samples * std::max<std::uint64_t>(header.bits, 8) / 8;
  check_file_size(task, pixels * header.samples * header.bits / 8,
                  largest_ratio(header.compression));
  allow_memory(2 * 12 * pixels + 4 * raw);
  DecodedImage picture = decode(tiff.get(), header);
  picture.image = upright(std::move(picture.image), header.orientation);
  return picture;
}

} // namespace haarlight::probe::reader
