// Pictures as EXR and PNG, and contact sheets.
#include "fixture.h"

#include <image/contact_sheet.h>
#include <image/false_colour.h>
#include <image/image_exr.h>
#include <image/png.h>

#include <wavelet/base/error.h>

#include <catch2/catch.hpp>

#include <cmath>

using namespace haarlight;
using namespace haarlight::testing;

namespace {

Image ramp(int width, int height) {
  Image picture(width, height);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i)
    picture.rgb[i] = static_cast<float>(i) / static_cast<float>(picture.rgb.size());
  return picture;
}

} // namespace

TEST_CASE("an EXR picture survives exactly", "[image]") {
  const TemporaryFolder folder;
  const Image picture = ramp(13, 7);
  image::write_exr(folder.file("a.exr"), picture);
  const Image back = image::read_exr(folder.file("a.exr"));
  CHECK(back.width == 13);
  CHECK(back.height == 7);
  CHECK(back.rgb == picture.rgb);
}

TEST_CASE("an EXR holds channels and attributes, and no clock", "[image]") {
  const TemporaryFolder folder;
  const Image picture = ramp(5, 3);
  image::ExrImage exr;
  exr.width = 5;
  exr.height = 3;
  exr.channels = {{"G", &picture.rgb[1], 3},
                  {"R", &picture.rgb[0], 3},
                  {"B", &picture.rgb[2], 3},
                  {"N.X", &picture.rgb[0], 3}};
  exr.texts = {{"haarlight:sampler", "product"}};
  exr.integers = {{"haarlight:spp", 16}};
  exr.numbers = {{"haarlight:seconds", 0.5}};
  image::write_exr(folder.file("a.exr"), exr);
  image::write_exr(folder.file("b.exr"), exr);
  CHECK(image::read_exr(folder.file("a.exr")).rgb == picture.rgb);
  const std::string bytes = read_bytes(folder.file("a.exr"));
  CHECK(bytes == read_bytes(folder.file("b.exr")));
  CHECK(bytes.find("haarlight:sampler") != std::string::npos);
  CHECK(bytes.find("N.X") != std::string::npos);
}

TEST_CASE("sRGB codes round to the nearest and come back", "[image]") {
  for (int code = 0; code < 256; ++code)
    CHECK(image::srgb_code(image::srgb_value(static_cast<unsigned char>(code))) == code);
  for (const double x : {0.001, 0.01, 0.18, 0.5, 0.9}) {
    const double code = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    CHECK(std::abs(image::srgb_code(static_cast<float>(x)) - 255 * code) <= 0.51);
  }
  CHECK(image::srgb_code(-1.0F) == 0);
  CHECK(image::srgb_code(std::nanf("")) == 0);
  CHECK(image::srgb_code(1e30F) == 255);
}

TEST_CASE("a PNG picture comes back to within a code", "[image]") {
  const TemporaryFolder folder;
  const Image picture = ramp(31, 17);
  image::write_png(folder.file("a.png"), picture);
  const Image back = image::read_png(folder.file("a.png"));
  REQUIRE(back.rgb.size() == picture.rgb.size());
  for (std::size_t i = 0; i < picture.rgb.size(); ++i)
    REQUIRE(image::srgb_code(back.rgb[i]) == image::srgb_code(picture.rgb[i]));
}

TEST_CASE("exposure and tone maps keep the order of values", "[image]") {
  Image picture(4, 1);
  picture.rgb = {0, 0.1F, 0.2F, 0.4F, 0.8F, 1, 2, 4, 8, 16, 1e30F, -1};
  Image filmic = picture;
  image::tone_map(filmic, {.exposure = -1, .tone_map = image::ToneMap::Filmic});
  image::tone_map(picture, {.exposure = 1});
  CHECK(picture.rgb[1] == Approx(0.2));
  CHECK(picture.rgb[6] == 1);
  CHECK(picture.rgb[11] == 0);
  CHECK(std::is_sorted(filmic.rgb.begin(), filmic.rgb.begin() + 11));
  CHECK(filmic.rgb[10] <= 1);
  CHECK(filmic.rgb[11] == 0);
}

TEST_CASE("broken pictures are refused", "[image]") {
  const TemporaryFolder folder;
  image::write_png(folder.file("a.png"), ramp(31, 17));
  image::write_exr(folder.file("a.exr"), ramp(31, 17));
  const std::string png = read_bytes(folder.file("a.png"));
  const std::string exr = read_bytes(folder.file("a.exr"));
  write_bytes(folder.file("cut.png"), png.substr(0, png.size() / 2));
  write_bytes(folder.file("cut.exr"), exr.substr(0, exr.size() - 100));
  CHECK_THROWS_AS(image::read_png(folder.file("cut.png")), Error);
  CHECK_THROWS_AS(image::read_exr(folder.file("cut.exr")), Error);
  CHECK_THROWS_AS(image::read_png(folder.file("a.exr")), Error);
  CHECK_THROWS_AS(image::read_exr(folder.file("a.png")), Error);
  CHECK_THROWS_AS(image::read_exr(folder.file("missing.exr")), Error);
}

TEST_CASE("a PNG whose file cannot hold its pixels is refused", "[image]") {
  const TemporaryFolder folder;
  image::write_png(folder.file("a.png"), ramp(31, 17));
  std::string png = read_bytes(folder.file("a.png"));
  // The header chunk with 16384 x 8192 pixels, and its checksum.
  png.replace(16, 17, std::string("\0\0\x40\0\0\0\x20\0\x08\x02\0\0\0\xad\x1c\xcb\x36", 17));
  write_bytes(folder.file("a.png"), png);
  try {
    image::read_png(folder.file("a.png"));
    FAIL("accepted");
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Catch::Contains("too short for its 16384 x 8192 pixels"));
  }
  // A black picture is small, and read.
  image::write_png(folder.file("black.png"), Image(2000, 1000));
  CHECK(std::filesystem::file_size(folder.file("black.png")) < 40000);
  CHECK(image::read_png(folder.file("black.png")).width == 2000);
}

TEST_CASE("a contact sheet shows every picture and its caption", "[image]") {
  Image red(10, 8);
  for (std::size_t i = 0; i < red.rgb.size(); i += 3)
    red.rgb[i] = 1;
  const Image sheet = image::contact_sheet({{red, "A"}, {red, ""}, {red, "b"}}, {.margin = 4});
  CHECK(sheet.width == 2 * 14 + 4);
  CHECK(sheet.height == 2 * (8 + 4 + 9) + 4);
  int reds = 0;
  int whites = 0;
  for (int y = 0; y < sheet.height; ++y)
    for (int x = 0; x < sheet.width; ++x) {
      reds += (sheet.at(x, y) == Rgb(1, 0, 0)).all() ? 1 : 0;
      whites += (sheet.at(x, y) == Rgb::Ones()).all() ? 1 : 0;
    }
  CHECK(reds == 240);
  CHECK(whites == 18 + 20); // pixels of the glyphs A and B
}

TEST_CASE("signed fields shrink to what stands out, and show their sign", "[image]") {
  const image::SignedField field{4, {1, -2, 0, 0, 0.5F, 0, 0, 0.1F, 0, 0, 3, 4, 0, -1, -5, 2}};
  const image::SignedField half = image::halved(field);
  CHECK(half.size == 2);
  CHECK(half.values == std::vector<float>{-2, 0.1F, -1, -5});
  CHECK((image::false_colour(0) == Rgb::Zero()).all());
  for (const float t : {0.1F, 0.5F, 1.0F}) {
    CHECK(image::false_colour(t)[0] > image::false_colour(t)[2]);
    CHECK((image::false_colour(t) == image::false_colour(-t).reverse()).all());
  }
  const Image picture = image::false_colour_picture(half, 160);
  CHECK(picture.width == 320);
  CHECK(picture.height == 320 + 22);
  CHECK((picture.at(319, 319) == image::false_colour(-1)).all());
  CHECK((picture.at(10, 10) == image::false_colour(std::cbrt(-0.4F))).all());
  CHECK(picture.at(1, 325)[2] > picture.at(1, 325)[0]); // the legend runs from below to above zero
  CHECK(picture.at(318, 325)[0] > picture.at(318, 325)[2]);
}

TEST_CASE("a picture is brightened to middle grey, a black one not at all", "[image]") {
  Image picture = ramp(9, 9);
  image::brighten(picture, image::middle_grey_gain(picture));
  double sum = 0;
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x)
      sum += static_cast<double>(luminance(picture.at(x, y)));
  CHECK(sum / 81 == Approx(0.18));
  CHECK(image::middle_grey_gain(Image(3, 3)) == 1);
}
