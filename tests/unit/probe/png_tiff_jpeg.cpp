// PNG, TIFF and JPEG files, made here, read as probes.

#include "probe_files.h"

#include <probe/read_probe.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>

#include <jpeglib.h>
#include <png.h>
#include <tiffio.h>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::bytes_of_file;
using haarlight::testing::error_of;
using haarlight::testing::ProbeFolder;

namespace {

std::string refusal(const std::string& path, const ImageChoice& choice = {}) {
  return error_of([&] { read_image(path, choice); });
}

struct PngOptions {
  int width = 1;
  int height = 1;
  int bits = 8;
  int type = PNG_COLOR_TYPE_RGB;
  std::function<void(png_structp, png_infop)> chunks = {};
};

/// @param samples bytes as stored, 16-bit values big-endian
std::string write_png(const std::string& path, const std::string& samples,
                      const PngOptions& options) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = ::png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = ::png_create_info_struct(png);
  ::png_init_io(png, file);
  ::png_set_IHDR(png, info, static_cast<png_uint_32>(options.width),
                 static_cast<png_uint_32>(options.height), options.bits, options.type,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (options.chunks)
    options.chunks(png, info);
  ::png_write_info(png, info);
  const std::size_t row = samples.size() / static_cast<std::size_t>(options.height);
  for (std::size_t y = 0; y < static_cast<std::size_t>(options.height); ++y)
    ::png_write_row(png, reinterpret_cast<png_const_bytep>(samples.data()) + y * row);
  ::png_write_end(png, info);
  ::png_destroy_write_struct(&png, &info);
  std::fclose(file);
  return path;
}

const std::string half_grey = "\x80\x80\x80";
constexpr float half_value = 128.0F / 255;

/// Stored as 2 columns of 3 rows, with the values 10 y + x + 1.
std::vector<float> numbered() { return {1, 2, 11, 12, 21, 22}; }

/// What an EXIF viewer shows, row by row, for each orientation of `numbered`.
struct Shown {
  int width;
  int height;
  std::vector<float> values;
};
const Shown shown[8] = {{2, 3, {1, 2, 11, 12, 21, 22}}, {2, 3, {2, 1, 12, 11, 22, 21}},
                        {2, 3, {22, 21, 12, 11, 2, 1}}, {2, 3, {21, 22, 11, 12, 1, 2}},
                        {3, 2, {1, 11, 21, 2, 12, 22}}, {3, 2, {21, 11, 1, 22, 12, 2}},
                        {3, 2, {22, 12, 2, 21, 11, 1}}, {3, 2, {2, 12, 22, 1, 11, 21}}};

struct TiffOptions {
  std::uint32_t width = 1;
  std::uint32_t height = 1;
  std::uint16_t samples = 3;
  std::uint16_t bits = 8;
  std::uint16_t format = SAMPLEFORMAT_UINT;
  std::function<void(TIFF*)> tags = {};
};

void write_page(TIFF* tiff, const void* samples, const TiffOptions& o) {
  ::TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, o.width);
  ::TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, o.height);
  ::TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, o.samples);
  ::TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, o.bits);
  ::TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, o.format);
  ::TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
                 o.samples >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
  ::TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  ::TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 1);
  if (o.tags)
    o.tags(tiff);
  const std::size_t row = std::size_t{o.width} * o.samples * o.bits / 8;
  for (std::uint32_t y = 0; y < o.height; ++y)
    ::TIFFWriteScanline(tiff, const_cast<char*>(static_cast<const char*>(samples)) + y * row, y, 0);
  ::TIFFWriteDirectory(tiff);
}

std::string write_tiff(const std::string& path, const void* samples, const TiffOptions& options,
                       const char* mode = "w") {
  TIFF* tiff = ::TIFFOpen(path.c_str(), mode);
  write_page(tiff, samples, options);
  ::TIFFClose(tiff);
  return path;
}

/// @param exif a block of EXIF data, or empty
std::string write_jpeg(const std::string& path, int width, int height,
                       const std::vector<unsigned char>& grey, const std::string& exif = {},
                       int components = 1) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = ::jpeg_std_error(&errors);
  ::jpeg_create_compress(&info);
  ::jpeg_stdio_dest(&info, file);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = components;
  info.in_color_space = components == 1 ? JCS_GRAYSCALE : JCS_CMYK;
  ::jpeg_set_defaults(&info);
  ::jpeg_set_quality(&info, 100, TRUE);
  ::jpeg_start_compress(&info, TRUE);
  if (!exif.empty())
    ::jpeg_write_marker(&info, JPEG_APP0 + 1, reinterpret_cast<const JOCTET*>(exif.data()),
                        static_cast<unsigned>(exif.size()));
  for (int y = 0; y < height; ++y) {
    auto* row = const_cast<JSAMPLE*>(grey.data()) + y * width * components;
    ::jpeg_write_scanlines(&info, &row, 1);
  }
  ::jpeg_finish_compress(&info);
  ::jpeg_destroy_compress(&info);
  std::fclose(file);
  return path;
}

std::string exif_block(int orientation, bool big_endian) {
  if (big_endian)
    return std::string("MM\0\x2a\0\0\0\x08\0\1\x01\x12\0\3\0\0\0\1\0", 19) +
           static_cast<char>(orientation) + std::string(6, '\0');
  return std::string("II\x2a\0\x08\0\0\0\1\0\x12\x01\3\0\1\0\0\0", 18) +
         static_cast<char>(orientation) + std::string(7, '\0');
}

void append(std::string& text, std::initializer_list<std::uint32_t> values) {
  for (const std::uint32_t value : values)
    for (int shift = 24; shift >= 0; shift -= 8)
      text += static_cast<char>(value >> shift & 0xff);
}

/// An ICC profile of sRGB's primaries, in the order of columns given, and a gamma of 2.
std::string icc_profile(const std::string& columns) {
  const std::array<std::uint32_t, 3> xyz[3] = {
      {0x6fa2, 0x38f5, 0x0390}, {0x6299, 0xb785, 0x18da}, {0x24a0, 0x0f84, 0xb6cf}};
  std::string tags;
  std::string data;
  const std::size_t data_offset = 132 + 6 * 12;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& primary = xyz[std::string("rgb").find(columns[i])];
    tags += std::string(1, "rgb"[i]) + "XYZ";
    append(tags, {static_cast<std::uint32_t>(data_offset + data.size()), 20});
    data += "XYZ ";
    append(data, {0, primary[0], primary[1], primary[2]});
    tags += std::string(1, "rgb"[i]) + "TRC";
    append(tags, {static_cast<std::uint32_t>(data_offset + data.size()), 14});
    data += "curv";
    append(data, {0, 1, 0x02000000});
  }
  std::string profile;
  append(profile, {static_cast<std::uint32_t>(data_offset + data.size()), 0, 0x02100000});
  profile += "mntrRGB XYZ " + std::string(12, '\0') + "acsp" + std::string(28, '\0');
  append(profile, {0xf6d6, 0x10000, 0xd32d}); // D50
  profile += std::string(48, '\0');
  append(profile, {6});
  return profile + tags + data;
}

} // namespace

TEST_CASE("The encoding that PNG chunks state is obeyed", "[png_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.png");
  const auto value = [&](const PngOptions& options) {
    return read_image(write_png(path, half_grey, options)).image.at(0, 0)[0];
  };
  const float srgb = std::pow((half_value + 0.055F) / 1.055F, 2.4F);
  CHECK(value({}) == Approx(srgb));
  CHECK(value({.chunks = [](png_structp p, png_infop i) { png_set_sRGB(p, i, 0); }}) ==
        Approx(srgb));
  CHECK(value({.chunks = [](png_structp p, png_infop i) { png_set_gAMA(p, i, 1.0); }}) ==
        Approx(half_value));
  CHECK(value({.chunks = [](png_structp p, png_infop i) { png_set_gAMA(p, i, 1 / 1.8); }}) ==
        Approx(std::pow(half_value, 1.8F)).epsilon(1e-4));
  const std::string profile = icc_profile("rgb");
  CHECK(value({.chunks = [&](png_structp p, png_infop i) {
          png_set_iCCP(p, i, "p", 0, reinterpret_cast<png_const_bytep>(profile.data()),
                       static_cast<png_uint_32>(profile.size()));
        }}) == Approx(half_value * half_value).epsilon(1e-3));
  CHECK(read_image(path).notes.size() == 1);
}

TEST_CASE("Primaries of PNG are converted", "[png_files]") {
  const ProbeFolder folder;
  const auto path = write_png(
      folder.path("a.png"), std::string("\xff\0\0", 3), {.chunks = [](png_structp p, png_infop i) {
        png_set_gAMA(p, i, 1.0);
        png_set_cHRM(p, i, 0.3127, 0.3290, 0.64, 0.33, 0.15, 0.06, 0.30, 0.60); // G and B swapped
      }});
  CHECK(read_image(path).image.at(0, 0)[0] == Approx(1).margin(1e-3));
  const auto blue = write_png(
      folder.path("b.png"), std::string("\0\xff\0", 3), {.chunks = [](png_structp p, png_infop i) {
        png_set_gAMA(p, i, 1.0);
        png_set_cHRM(p, i, 0.3127, 0.3290, 0.64, 0.33, 0.15, 0.06, 0.30, 0.60);
      }});
  CHECK((read_image(blue).image.at(0, 0) - Rgb(0, 0, 1)).abs().maxCoeff() < 1e-3F);
}

TEST_CASE("Depths, grey, palettes and alpha of PNG", "[png_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.png");
  const auto linear = [](png_structp p, png_infop i) { png_set_gAMA(p, i, 1.0); };
  const auto read = [&](const std::string& samples, const PngOptions& options) {
    return read_image(write_png(path, samples, options)).image.at(0, 0);
  };
  CHECK(read(std::string("\x40\x00\x80\x00\xff\xff", 6), {.bits = 16, .chunks = linear})[0] ==
        Approx(0x4000 / 65535.0));
  CHECK(read("\x80", {.type = PNG_COLOR_TYPE_GRAY, .chunks = linear})[2] == Approx(half_value));
  CHECK(read("\x80", {.bits = 1, .type = PNG_COLOR_TYPE_GRAY, .chunks = linear})[1] == 1);
  const Rgb transparent =
      read("\xff\x80\xff\x80", {.type = PNG_COLOR_TYPE_RGB_ALPHA, .chunks = linear});
  CHECK(transparent[0] == Approx(half_value));
  CHECK(transparent[1] == Approx(half_value * half_value));
  CHECK(read_image(path).notes.size() == 2);
}

TEST_CASE("All eight orientations of TIFF, JPEG and PNG", "[orientation]") {
  const ProbeFolder folder;
  const std::vector<float> stored = numbered();
  for (int orientation = 1; orientation <= 8; ++orientation) {
    INFO("orientation " << orientation);
    const Shown& wanted = shown[orientation - 1];
    const auto tiff = read_image(
        write_tiff(folder.path("a.tif"), stored.data(),
                   {.width = 2,
                    .height = 3,
                    .samples = 1,
                    .bits = 32,
                    .format = SAMPLEFORMAT_IEEEFP,
                    .tags = [&](TIFF* t) { TIFFSetField(t, TIFFTAG_ORIENTATION, orientation); }}));
    REQUIRE((tiff.image.width == wanted.width && tiff.image.height == wanted.height));
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(tiff.image.rgb[3 * i] == wanted.values[i]);

    std::vector<unsigned char> grey;
    for (const float value : stored)
      grey.push_back(static_cast<unsigned char>(value));
    const std::string exif = exif_block(orientation, orientation % 2 == 0);
    const auto png =
        read_image(write_png(folder.path("a.png"), std::string(grey.begin(), grey.end()),
                             {.width = 2,
                              .height = 3,
                              .type = PNG_COLOR_TYPE_GRAY,
                              .chunks = [&](png_structp p, png_infop i) {
                                std::string copy = exif;
                                png_set_gAMA(p, i, 1.0);
                                png_set_eXIf_1(p, i, static_cast<png_uint_32>(copy.size()),
                                               reinterpret_cast<png_bytep>(copy.data()));
                              }}));
    REQUIRE(png.image.width == wanted.width);
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(png.image.rgb[3 * i] * 255 == Approx(wanted.values[i]));

    // JPEG's blocks smooth single pixels: each becomes a block of 8 x 8
    std::vector<unsigned char> blocks;
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 16; ++x)
        blocks.push_back(
            static_cast<unsigned char>(10 * stored[static_cast<std::size_t>(y / 8 * 2 + x / 8)]));
    const auto jpeg = read_image(
        write_jpeg(folder.path("a.jpg"), 16, 24, blocks, std::string("Exif\0\0", 6) + exif));
    REQUIRE(jpeg.image.width == 8 * wanted.width);
    for (int y = 0; y < wanted.height; ++y)
      for (int x = 0; x < wanted.width; ++x) {
        const double encoded =
            wanted.values[static_cast<std::size_t>(y * wanted.width + x)] * 10 / 255;
        const double value =
            encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
        CHECK(jpeg.image.at(8 * x + 4, 8 * y + 4)[0] == Approx(value).epsilon(0.02).margin(5e-4));
      }
  }
}

TEST_CASE("Sample formats of TIFF", "[tiff_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.tif");
  const std::uint16_t wide[3] = {0x4000, 0x8000, 0xffff};
  const auto sixteen = read_image(write_tiff(path, wide, {.bits = 16}));
  CHECK(sixteen.image.at(0, 0)[0] == Approx(0x4000 / 65535.0));
  REQUIRE(sixteen.notes.size() == 1);
  CHECK_THAT(sixteen.notes[0], Catch::Contains("16 bits") && Catch::Contains("linear"));
  CHECK(read_image(write_tiff(path, wide, {.bits = 16}, "wb")).image.at(0, 0)[0] ==
        Approx(0x4000 / 65535.0));
  const double real[3] = {0.5, 2000, 1e10};
  CHECK(read_image(write_tiff(path, real, {.bits = 64, .format = SAMPLEFORMAT_IEEEFP}))
            .image.at(0, 0)[2] == Approx(1e10));
  const std::uint16_t halves[3] = {0x3800, 0x3c00, 0x4000}; // 0.5, 1, 2
  CHECK((read_image(write_tiff(path, halves, {.bits = 16, .format = SAMPLEFORMAT_IEEEFP}))
             .image.at(0, 0) == Rgb(0.5F, 1, 2))
            .all());
  CHECK(read_image(write_tiff(path, "\x80\x80\x80", {})).image.at(0, 0)[0] ==
        Approx(0.2159).epsilon(1e-3));
  CHECK_THAT(refusal(write_tiff(path, wide, {.bits = 16, .format = SAMPLEFORMAT_INT})),
             Catch::Contains("SampleFormat 2"));
}

TEST_CASE("Alpha, ICC profiles and tiles of TIFF", "[tiff_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.tif");
  const float rgba[4] = {1, 2, 4, 0.5F};
  for (const std::uint16_t type :
       {std::uint16_t{EXTRASAMPLE_ASSOCALPHA}, std::uint16_t{EXTRASAMPLE_UNASSALPHA}}) {
    const auto loaded = read_image(write_tiff(
        path, rgba, {.samples = 4, .bits = 32, .format = SAMPLEFORMAT_IEEEFP, .tags = [&](TIFF* t) {
                       TIFFSetField(t, TIFFTAG_EXTRASAMPLES, 1, &type);
                     }}));
    CHECK(loaded.image.at(0, 0)[2] == (type == EXTRASAMPLE_UNASSALPHA ? 2 : 4));
  }
  const std::string profile = icc_profile("rbg");
  const auto with_profile = read_image(
      write_tiff(path, "\xff\x80\0", {.tags = [&](TIFF* t) {
                   TIFFSetField(t, TIFFTAG_ICCPROFILE, static_cast<std::uint32_t>(profile.size()),
                                profile.data());
                 }}));
  const float squared = half_value * half_value;
  CHECK((with_profile.image.at(0, 0) - Rgb(1, 0, squared)).abs().maxCoeff() < 2e-3F);
  std::vector<float> tile(std::size_t{16} * 16);
  for (std::size_t i = 0; i < tile.size(); ++i)
    tile[i] = static_cast<float>(i);
  TIFF* tiff = ::TIFFOpen(path.c_str(), "w");
  ::TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 20);
  ::TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 16);
  ::TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  ::TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32);
  ::TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  ::TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  ::TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
  ::TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
  for (const std::uint32_t x : {0U, 16U})
    ::TIFFWriteTile(tiff, tile.data(), x, 0, 0, 0);
  ::TIFFClose(tiff);
  const auto tiled = read_image(path);
  CHECK(tiled.image.at(15, 2)[0] == 47);
  CHECK(tiled.image.at(18, 3)[1] == 50);
}

TEST_CASE("Pages of TIFF are chosen as parts", "[tiff_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.tif");
  const float first[3] = {1, 1, 1};
  const float second[3] = {2, 2, 2};
  const TiffOptions real{.bits = 32, .format = SAMPLEFORMAT_IEEEFP};
  TiffOptions thumbnail = real;
  thumbnail.tags = [](TIFF* t) { TIFFSetField(t, TIFFTAG_SUBFILETYPE, FILETYPE_REDUCEDIMAGE); };
  write_tiff(path, first, thumbnail);
  write_tiff(path, second, real, "a");
  CHECK(read_image(path).image.at(0, 0)[0] == 2);
  write_tiff(path, first, real);
  write_tiff(path, second, real, "a");
  CHECK_THAT(refusal(path), Catch::Contains("2 pages"));
  CHECK(read_image(path, {"", "1"}).image.at(0, 0)[0] == 2);
  CHECK_THAT(refusal(path, {"", "2"}), Catch::Contains("no page '2'"));
}

TEST_CASE("Damaged and unsuitable PNG, TIFF and JPEG are refused", "[foreign_files]") {
  const ProbeFolder folder;
  const std::vector<unsigned char> grey(64 * 64, 77);
  std::vector<unsigned char> noise(64 * 64);
  for (std::size_t i = 0; i < noise.size(); ++i)
    noise[i] = static_cast<unsigned char>(i * i * 7 + i / 3);
  const std::string jpeg = bytes_of_file(write_jpeg(folder.path("a.jpg"), 64, 64, noise));
  const std::string png =
      bytes_of_file(write_png(folder.path("a.png"), std::string(noise.begin(), noise.end()),
                              {.width = 64, .height = 64, .type = PNG_COLOR_TYPE_GRAY}));
  const std::string tiff = bytes_of_file(
      write_tiff(folder.path("a.tif"), noise.data(), {.width = 64, .height = 64, .samples = 1}));
  for (const std::string& whole : {jpeg, png, tiff})
    for (const std::size_t count : {std::size_t{12}, whole.size() / 2, whole.size() - 60}) {
      const std::string message = refusal(folder.write("cut", whole.substr(0, count)));
      INFO(whole.substr(1, 3) << " " << count << ": " << message);
      CHECK_THAT(message, Catch::Contains("cut: "));
    }
  std::string huge = jpeg;
  const std::size_t frame = huge.find("\xff\xc0");
  REQUIRE(frame != std::string::npos);
  huge.replace(frame + 5, 4, "\xff\xff\xff\xff");
  CHECK_THAT(refusal(folder.write("huge.jpg", huge)), Catch::Contains("65500"));
  huge.replace(frame + 5, 4, std::string("\x20\0\x40\0", 4));
  CHECK_THAT(refusal(folder.write("huge.jpg", huge)), Catch::Contains("cut short"));
  const std::vector<unsigned char> cmyk(std::size_t{4} * 64, 1);
  CHECK_THAT(refusal(write_jpeg(folder.path("cmyk.jpg"), 8, 8, cmyk, {}, 4)),
             Catch::Contains("4 colour components"));
  CHECK_THAT(refusal(folder.path("a.jpg"), {"beauty", ""}), Catch::Contains("no layers"));
}
