#include "probe_files.h"

#include <probe/rgbe.h>

#include <algorithm>
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

using Pixel = std::array<std::uint8_t, 4>;

/// The four bytes that the writer stores for a colour.
Pixel encode(const Rgb& colour, const ProbeFolder& folder) {
  Image image(1, 1);
  image.set(0, 0, colour);
  write_rgbe(folder.path("pixel.hdr"), image);
  const std::string bytes = haarlight::testing::bytes_of_file(folder.path("pixel.hdr"));
  Pixel stored;
  std::copy(bytes.end() - 4, bytes.end(), stored.begin());
  return stored;
}

Rgb decode(const Pixel& p) {
  const float unit = p[3] == 0 ? 0.0F : std::ldexp(1.0F, p[3] - 136);
  return Rgb(p[0], p[1], p[2]) * unit;
}

} // namespace

TEST_CASE("RGBE encoding rounds to the nearest", "[rgbe]") {
  const ProbeFolder folder;
  CHECK(encode({1, 0.5F, 0}, folder) == Pixel{128, 64, 0, 129});
  CHECK(encode({0, 0, 0}, folder) == Pixel{0, 0, 0, 0});
  CHECK(encode({-3, -1, -0.5F}, folder) == Pixel{0, 0, 0, 0});
  // 255.6/256 rounds up to the next power of two, and all mantissas with it.
  CHECK(encode({255.6F / 256, 0.25F, 0}, folder) == Pixel{128, 32, 0, 129});
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int i = 0; i < 300; ++i) {
    const Rgb colour = Rgb(uniform(random), uniform(random), uniform(random)) *
                       std::ldexp(1.0F, static_cast<int>(random() % 60) - 30);
    const Rgb back = decode(encode(colour, folder));
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
          REQUIRE((back.at(x, y) == decode(encode(image.at(x, y), folder))).all());
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
  // A pixel between two repeats restarts the count.
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
  CHECK_THAT(refusal("#?RADIANCE\n" + std::string(2 << 20, 'x') + "\n\n-Y 1 +X 1\n" + grey(1)),
             Catch::Contains("does not end"));
  CHECK_THAT(refusal(file("-Y 1 +X 1", grey(1), std::string("EXPOSURE=2\0\n", 12))),
             Catch::Contains("NUL") && Catch::Contains("byte 11"));
  CHECK_THAT(refusal(file("-Y 1 +X 1", grey(1), "FORMAT=16-bit\n")), Catch::Contains("FORMAT"));
  for (const char* exposure :
       {"EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=nan\n", "EXPOSURE=x\n", "EXPOSURE=1 2\n",
        "EXPOSURE=inf\n", "COLORCORR=1 2\n", "EXPOSURE=1e300\n", "COLORCORR=1 1 1e-300\n"})
    CHECK_THAT(refusal(file("-Y 1 +X 1", grey(1), exposure)), Catch::Contains("byte 11"));
  for (const char* size : {"Y 1 X 1", "-Y 1 +Y 1", "-Y 0 +X 1", "-Y -1 +X 1", "-Y 1 +X",
                           "-Y 1 +X 1 2", "-Y 99999999999999999999 +X 1", "-Y a +X 1", "junk"})
    CHECK_THAT(refusal(file(size, grey(1))), Catch::Contains("size line"));
  CHECK_THAT(refusal(file("-Y 100000 +X 100000", grey(1))), Catch::Contains("at most"));
  CHECK_THAT(refusal(file("-Y 10000 +X 10000", grey(3))), Catch::Contains("cut short"));
  // 250 bytes that claim 20 million pixels, as noise after a header does.
  CHECK_THAT(refusal(file("-Y 6 +X 3333333", std::string(200, '3'))), Catch::Contains("cut short"));
  CHECK_THAT(refusal(file("-Y 8192 +X 16384", grey(3) + pixel(1, 1, 1, 255))),
             Catch::Contains("cut short"));
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

TEST_CASE("RGBE is recognised whatever its first line", "[rgbe]") {
  const auto recognised = [](const std::string& text) {
    return is_rgbe(std::as_bytes(std::span(text.data(), text.size())));
  };
  const std::string data = grey(96) + grey(48);
  const std::string rest = "FORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n+Y 2 +X 1\n" + data;
  for (const std::string first : {"#?RADIANCE\n", "#?RGBE\n", "#?AUTOPANO\n", "#?\n",
                                  "made by hand\n", "", "\xef\xbb\xbf#?\n"}) {
    INFO(first);
    REQUIRE(recognised(first + rest));
    const Image image = parse(first + rest);
    CHECK(image.at(0, 0)[0] == 24);
    CHECK(image.at(0, 1)[0] == 48);
  }
  // Without FORMAT, the size line after the blank line decides.
  CHECK(parse("picture of a program\r\nEXPOSURE=4\r\n\r\n-Y 2 +X 1\r\n" + data).at(0, 0)[0] == 24);
  CHECK(parse("\n-Y 2 +X 1\n" + data).at(0, 1)[0] == 48);
  CHECK(recognised("FORMAT=32-bit_rle_rgbe\n"));
  CHECK_FALSE(recognised("text\n\nmore text\n"));
  CHECK_FALSE(recognised("PF\n1 1\n-1.0\n" + data));
  CHECK_FALSE(recognised(std::string(1, '\0') + "\n\n-Y 2 +X 1\n" + data));
  CHECK_FALSE(recognised(""));
}

TEST_CASE("Header variables begin in the first column", "[rgbe]") {
  const auto value = [](const std::string& variables) {
    return parse(file("-Y 1 +X 1", grey(96), variables)).at(0, 0)[0];
  };
  const std::string format = "FORMAT=32-bit_rle_rgbe\n";
  for (const std::string line :
       {"EXPOSURE=8", "COLORCORR=2 2 2", "FORMAT=32-bit_rle_xyze", "FORMAT=ascii", "GAMMA=2.2",
        "PRIMARIES=.7 .3 .2 .7 .1 .1 .31 .33", "EXPOSURE=nonsense"}) {
    INFO(line);
    for (const std::string indent : {" ", "\t", "\t\t"})
      CHECK(value("input.hdr:\n" + indent + line + "\n" + format) == 96);
    CHECK(value("X" + line + "\n# " + line + "\n" + format) == 96);
  }
  // An indented empty line does not end the header either.
  CHECK(value("a.hdr:\n\tEXPOSURE=8\n\t\nEXPOSURE=2\n") == 48);
  CHECK(value("EXPOSURE =8\nVIEW= -vta -vh 180\nPIXASPECT=2\nSOFTWARE=x\n") == 96);
  CHECK(value(std::string(100000, 'c') + "EXPOSURE=8\nEXPOSURE=2\n") == 48);
}

TEST_CASE("GAMMA must be linear", "[rgbe]") {
  const auto parsed = [](const std::string& gamma) {
    return error_of([&] { parse(file("-Y 1 +X 1", grey(96), gamma)); });
  };
  CHECK(parsed("GAMMA=1\n").empty());
  CHECK(parsed("GAMMA=1.0\n").empty());
  CHECK(parsed("GAMMA=0\n").empty());
  CHECK_THAT(parsed("GAMMA=2.2\n"), Catch::Contains("GAMMA is '2.2'"));
  CHECK_THAT(parsed("GAMMA=x\n"), Catch::Contains("GAMMA"));
}

TEST_CASE("PRIMARIES are converted to Rec. 709", "[rgbe]") {
  const auto colour = [](const std::string& pixels, const std::string& primaries) {
    return parse(file("-Y 1 +X 1", pixels, "PRIMARIES=" + primaries + "\n")).at(0, 0);
  };
  const std::string mixed = pixel(200, 100, 50, 136);
  for (const char* same : {"0 0 0 0 0 0 0 0", ".64 .33 .3 .6 .15 .06 .3127 .329",
                           "0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333"})
    CHECK((colour(mixed, same) == Rgb(200, 100, 50)).all());
  // ITU-R BT.2087: Rec. 2020 to Rec. 709.
  const Rgb wide = colour(mixed, "0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.3290");
  CHECK(wide[0] == Approx(1.6605 * 200 - 0.5876 * 100 - 0.0728 * 50).epsilon(1e-3));
  CHECK(wide[1] == Approx(-0.1246 * 200 + 1.1329 * 100 - 0.0083 * 50).epsilon(1e-3));
  CHECK(wide[2] == Approx(-0.0182 * 200 - 0.1006 * 100 + 1.1187 * 50).epsilon(1e-3));
  // Grey stays grey for any white.
  for (const char* white : {" 0.3333 0.3333", " 0.3457 0.3585"}) {
    const Rgb grey_value = colour(grey(96), std::string(".708 .292 .17 .797 .131 .046") + white);
    for (int c = 0; c < 3; ++c)
      CHECK(grey_value[c] == Approx(96).epsilon(1e-5));
  }
  for (const char* bad : {"1 2 3", "0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3", ".64 .33 .3 .6 .15 .06 .3 0",
                          ".64 .33 .3 .6 .15 .06 .3 nan", "1 2 3 4 5 6 7 8 9"})
    CHECK_THAT(error_of([&] { colour(mixed, bad); }), Catch::Contains("PRIMARIES"));
}

TEST_CASE("A picture of few bytes is read if they hold all of its pixels", "[rgbe]") {
  // Black in the densest new coding: 127 pixels in 2 bytes.
  std::string line = pixel(2, 2, 4096 >> 8, 0);
  for (int component = 0; component < 4; ++component) {
    for (int run = 0; run < 4096 / 127; ++run)
      line += std::string("\xff\0", 2);
    line += std::string{static_cast<char>(128 + 4096 % 127), '\0'};
  }
  std::string lines;
  for (int y = 0; y < 64; ++y)
    lines += line;
  const Image coded = parse(file("-Y 64 +X 4096", lines));
  CHECK((coded.width == 4096 && coded.height == 64));
  CHECK(std::all_of(coded.rgb.begin(), coded.rgb.end(), [](float v) { return v == 0; }));
  // A chain of old repeats: 1 + 1·256 + 2·65536 pixels in 16 bytes.
  const Image chained = parse(
      file("-Y 1 +X 131329", grey(9) + pixel(1, 1, 1, 0) + pixel(1, 1, 1, 1) + pixel(1, 1, 1, 2)));
  CHECK(chained.at(131328, 0)[0] == 9);
  // Flat pixels in a scanline too long for the new coding.
  const Image flat = parse(file("-Y 1 +X 32768", grey(2) + pixel(2, 2, 0, 136) +
                                                     pixel(1, 1, 1, 254) + pixel(1, 1, 1, 127)));
  CHECK(flat.at(0, 0)[2] == 2);
  CHECK(flat.at(32767, 0)[2] == 0);
}

TEST_CASE("A damaged RGBE file is read or refused, never anything else", "[rgbe]") {
  const ProbeFolder folder;
  write_rgbe(folder.path("whole.hdr"), noisy_image(40, 6, true), {"made for a test"});
  const std::string whole = haarlight::testing::bytes_of_file(folder.path("whole.hdr"));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    try {
      const Image image = parse(damaged);
      REQUIRE(image.rgb.size() == 3 * image.width * static_cast<std::size_t>(image.height));
    } catch (const Error& error) {
      REQUIRE(error.kind() == ErrorKind::Input);
    }
  }
  for (const std::string extent : {"0", "-1", "127", "2147483647", "2147483648", "4294967295",
                                   "4294967296", "18446744073709551615"})
    for (const std::string other : {"1", "6", extent.c_str()}) {
      std::string damaged = whole;
      damaged.replace(damaged.find("-Y 6 +X 40"), 10, "-Y " + other + " +X " + extent);
      INFO(extent << ' ' << other);
      CHECK_FALSE(error_of([&] { parse(damaged); }).empty());
    }
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
