#include "probe_files.h"

#include <probe/rgbe.h>

#include <cmath>
#include <random>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::error_of;
using haarlight::testing::ProbeFolder;

namespace {

Image parse(const std::string& text) {
  return read_rgbe(std::as_bytes(std::span(text.data(), text.size())), "probe.hdr");
}

std::string pixel(int r, int g, int b, int e) {
  return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}

std::string file(const std::string& size_line, const std::string& data,
                 const std::string& variables = "FORMAT=32-bit_rle_rgbe\n") {
  return "#?RADIANCE\n" + variables + "\n" + size_line + "\n" + data;
}

/// Grey of the value 1 is mantissa 128 with exponent 129.
std::string grey(int mantissa) { return pixel(mantissa, mantissa, mantissa, 136); }

Image noisy_image(int width, int height, bool with_runs) {
  std::mt19937 random(7);
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto draw = [&] {
        return std::ldexp(static_cast<float>(random() % 1000), int(random() % 20) - 10);
      };
      const bool repeat = with_runs && x > 0 && random() % 8 != 0;
      image.set(x, y, repeat ? image.at(x - 1, y) : Rgb(draw(), draw(), draw()));
    }
  return image;
}

} // namespace

TEST_CASE("RGBE encoding rounds to the nearest", "[rgbe]") {
  CHECK(encode_rgbe({1, 0.5F, 0}) == std::array<std::uint8_t, 4>{128, 64, 0, 129});
  CHECK(encode_rgbe({0, 0, 0}) == std::array<std::uint8_t, 4>{0, 0, 0, 0});
  CHECK(encode_rgbe({-3, -1, -0.5F}) == std::array<std::uint8_t, 4>{0, 0, 0, 0});
  // 255.6/256 rounds up to the next power of two, and all mantissas with it.
  CHECK(encode_rgbe({255.6F / 256, 0.25F, 0}) == std::array<std::uint8_t, 4>{128, 32, 0, 129});
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 10000; ++i) {
    const Rgb colour = Rgb(uniform(random), uniform(random), uniform(random)) *
                       std::ldexp(1.0F, static_cast<int>(random() % 60) - 30);
    const Rgb back = decode_rgbe(encode_rgbe(colour));
    REQUIRE((back - colour).abs().maxCoeff() <= colour.maxCoeff() / 256);
  }
}

TEST_CASE("What is written is read back, in every width and coding", "[rgbe]") {
  const ProbeFolder folder;
  for (const int width : {1, 3, 7, 8, 9, 127, 128, 129, 300}) {
    for (const bool with_runs : {false, true}) {
      const Image image = noisy_image(width, 5, with_runs);
      const std::string path = folder.path("probe.hdr");
      write_rgbe(path, image, {"made for a test"});
      const std::string bytes = haarlight::testing::bytes_of_file(path);
      const Image back = parse(bytes);
      REQUIRE((back.width == width && back.height == 5));
      for (int y = 0; y < 5; ++y)
        for (int x = 0; x < width; ++x)
          REQUIRE((back.at(x, y) == decode_rgbe(encode_rgbe(image.at(x, y)))).all());
    }
  }
  const Image flat(256, 16);
  write_rgbe(folder.path("flat.hdr"), flat);
  CHECK(haarlight::testing::bytes_of_file(folder.path("flat.hdr")).size() < 16 * 40 + 80);
}

TEST_CASE("All eight orientations give the same picture", "[rgbe]") {
  // Three columns, two rows; mantissa = 100 + 10 · row + column.
  struct Orientation {
    const char* size_line;
    std::vector<int> mantissas;
  };
  const std::vector<Orientation> orientations = {
      {"-Y 2 +X 3", {100, 101, 102, 110, 111, 112}}, {"-Y 2 -X 3", {102, 101, 100, 112, 111, 110}},
      {"+Y 2 +X 3", {110, 111, 112, 100, 101, 102}}, {"+Y 2 -X 3", {112, 111, 110, 102, 101, 100}},
      {"+X 3 -Y 2", {100, 110, 101, 111, 102, 112}}, {"+X 3 +Y 2", {110, 100, 111, 101, 112, 102}},
      {"-X 3 -Y 2", {102, 112, 101, 111, 100, 110}}, {"-X 3 +Y 2", {112, 102, 111, 101, 110, 100}}};
  for (const auto& [size_line, mantissas] : orientations) {
    std::string data;
    for (const int mantissa : mantissas)
      data += grey(mantissa);
    const Image image = parse(file(size_line, data));
    INFO(size_line);
    REQUIRE((image.width == 3 && image.height == 2));
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 3; ++x)
        CHECK(image.at(x, y)[1] == static_cast<float>(100 + 10 * y + x));
  }
}

TEST_CASE("Exposures multiply up and are divided out", "[rgbe]") {
  const std::string data = grey(96);
  CHECK(parse(file("-Y 1 +X 1", data, "EXPOSURE=2\nEXPOSURE= 1.5 \n")).at(0, 0)[0] == 32);
  const Rgb corrected = parse(file("-Y 1 +X 1", data, "COLORCORR=1 2 4\nEXPOSURE=+0.5\n")).at(0, 0);
  CHECK((corrected == Rgb(192, 96, 48)).all());
  CHECK(parse(file("-Y 1 +X 1", data, "# EXPOSURE=2\nGAMMA=1\nPRIMARIES=0 0 0 0 0 0 0 0\n"))
            .at(0, 0)[0] == 96);
  CHECK(parse("#?RGBE\r\nEXPOSURE=1\r\n\r\n-Y 1 +X 1\r\n" + data).at(0, 0)[0] == 96);
}

TEST_CASE("XYZE becomes Rec. 709", "[rgbe]") {
  // The white of D65: X, Y, Z = 0.9505, 1, 1.089, in steps of 1/128.
  const Image image =
      parse(file("-Y 1 +X 1", pixel(122, 128, 139, 129), "FORMAT=32-bit_rle_xyze\n"));
  for (int c = 0; c < 3; ++c)
    CHECK(image.at(0, 0)[c] == Approx(1).margin(0.02));
}

TEST_CASE("Old run lengths", "[rgbe]") {
  // 1 pixel, repeated 43 + 1·256 times: 300 in all.
  const std::string line = grey(7) + pixel(1, 1, 1, 43) + pixel(1, 1, 1, 1);
  const Image image =
      parse(file("-Y 2 +X 300", line + grey(9) + pixel(1, 1, 1, 43) + pixel(1, 1, 1, 1)));
  CHECK(image.at(299, 0)[0] == 7);
  CHECK(image.at(0, 1)[0] == 9);
  // A pixel between two repeats starts the count anew.
  const Image mixed =
      parse(file("-Y 1 +X 8", grey(5) + pixel(1, 1, 1, 3) + grey(6) + pixel(1, 1, 1, 3)));
  CHECK(mixed.at(3, 0)[0] == 5);
  CHECK(mixed.at(4, 0)[0] == 6);
  CHECK(mixed.at(7, 0)[0] == 6);
}

TEST_CASE("Bytes after the last scanline are ignored", "[rgbe]") {
  CHECK(parse(file("-Y 1 +X 1", grey(3) + "\n")).at(0, 0)[0] == 3);
  CHECK(parse(file("-Y 1 +X 1", grey(3) + "trailer")).at(0, 0)[0] == 3);
}

TEST_CASE("Malformed RGBE is refused with its place", "[rgbe]") {
  const auto refusal = [](const std::string& bytes) { return error_of([&] { parse(bytes); }); };
  const std::string rle_head = pixel(2, 2, 0, 8);
  const std::string rle_line = rle_head + std::string("\x88\x01\x88\x02\x88\x03\x88\x80", 8);
  CHECK(refusal(file("-Y 1 +X 8", rle_line)).empty());

  CHECK_THAT(refusal("P6 2 2 255"), Catch::Contains("#?RADIANCE"));
  CHECK_THAT(refusal("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"), Catch::Contains("does not end"));
  CHECK_THAT(refusal(file("-Y 1 +X 1", grey(1), "FORMAT=16-bit\n")), Catch::Contains("FORMAT"));
  for (const char* exposure : {"EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=nan\n", "EXPOSURE=x\n",
                               "EXPOSURE=1 2\n", "EXPOSURE=inf\n", "COLORCORR=1 2\n"})
    CHECK_THAT(refusal(file("-Y 1 +X 1", grey(1), exposure)), Catch::Contains("byte 11"));
  for (const char* size : {"Y 1 X 1", "-Y 1 +Y 1", "-Y 0 +X 1", "-Y -1 +X 1", "-Y 1 +X",
                           "-Y 1 +X 1 2", "-Y 99999999999999999999 +X 1", "-Y a +X 1", "junk"})
    CHECK_THAT(refusal(file(size, grey(1))), Catch::Contains("size line"));
  CHECK_THAT(refusal(file("-Y 100000 +X 100000", grey(1))), Catch::Contains("at most"));
  CHECK_THAT(refusal(file("-Y 10000 +X 10000", grey(1))), Catch::Contains("cut short"));
  CHECK_THAT(refusal(file("-Y 1 +X 8", pixel(2, 2, 0, 9) + std::string(40, 'x'))),
             Catch::Contains("9 pixels"));
  CHECK_THAT(
      refusal(file("-Y 1 +X 8", rle_head + std::string("\x89\x01", 2) + std::string(40, 'x'))),
      Catch::Contains("run of 9"));
  CHECK_THAT(
      refusal(file("-Y 1 +X 8", rle_head + std::string("\x00\x01", 2) + std::string(40, 'x'))),
      Catch::Contains("run of 0"));
  CHECK_THAT(refusal(file("-Y 1 +X 9", pixel(1, 1, 1, 4) + std::string(40, 'x'))),
             Catch::Contains("repeat"));
  CHECK_THAT(refusal(file("-Y 1 +X 9", grey(1) + pixel(1, 1, 1, 9) + std::string(40, 'x'))),
             Catch::Contains("repeat"));
}

TEST_CASE("A picture cut anywhere is refused", "[rgbe]") {
  const ProbeFolder folder;
  write_rgbe(folder.path("whole.hdr"), noisy_image(40, 6, true));
  const std::string whole = haarlight::testing::bytes_of_file(folder.path("whole.hdr"));
  for (std::size_t length = 0; length < whole.size(); length += 3) {
    INFO(length);
    CHECK_FALSE(error_of([&] { parse(whole.substr(0, length)); }).empty());
  }
  CHECK_THAT(error_of([&] { parse(whole.substr(0, whole.size() - 1)); }),
             Catch::Contains("scanline 5") &&
                 Catch::Contains("byte " + std::to_string(whole.size() - 1)));
}

TEST_CASE("An RGBE file that cannot be written leaves nothing", "[rgbe]") {
  const ProbeFolder folder;
  const Image image(8, 8);
  CHECK_FALSE(error_of([&] { write_rgbe(folder.path("missing/probe.hdr"), image); }).empty());
  CHECK_FALSE(error_of([&] { write_rgbe(folder.path(""), image); }).empty());
}
