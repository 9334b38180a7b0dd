// EXR files of other programs and damaged ones: the right picture, or one clear refusal before
// memory is allocated.
#include "exr_bytes.h"
#include "fixture.h"

#include <image/image_exr.h>
#include <image/map_set_exr.h>

#include <wavelet/base/error.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <limits>

using namespace haarlight;
using namespace haarlight::testing;

namespace {

Image read(const std::string& bytes) {
  const TemporaryFolder folder;
  write_bytes(folder.file("a.exr"), bytes);
  return image::read_exr(folder.file("a.exr"));
}

/// The message of the refusal as a picture, which must also be refused as a map; empty if it is
/// read.
std::string refusal(const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  write_bytes(path, bytes);
  try {
    image::read_exr(path);
  } catch (const Error& error) {
    CHECK(error.kind() == ErrorKind::Input);
    CHECK(error.path() == path);
    CHECK(std::string(error.what()).find('\n') == std::string::npos);
    CHECK_THROWS_AS(image::ExrMapSource(path).make(0, 0), Error);
    return error.what();
  }
  return {};
}

double position_value(int x, int y, std::size_t c) {
  return 100 * x + 10 * y + static_cast<int>(c);
}

/// 4 × 4 pixels B, G, R of position_value().
ExrBytes small() {
  return ExrBytes::scanlines({"B", "G", "R"}, box(0, 0, 3, 3), box(0, 0, 3, 3), position_value);
}

std::string refusal_of(const std::function<void(ExrBytes&)>& damage) {
  ExrBytes exr = small();
  damage(exr);
  return refusal(exr.bytes());
}

std::string named(const std::vector<std::string>& channels) {
  return refusal(
      ExrBytes::scanlines(channels, box(0, 0, 1, 1), box(0, 0, 1, 1), position_value).bytes());
}

/// A tiled image of levels of halving size, one tile of 4 × 4 pixels or less each.
ExrBytes mip_mapped() {
  ExrBytes exr = small();
  exr.version |= 0x200U;
  exr.attributes.push_back({"tiles", "tiledesc", raw(4U) + raw(4U) + std::string(1, '\1')});
  exr.chunks.clear();
  for (int level = 0; level < 3; ++level) {
    std::string pixels;
    const int size = 4 >> level;
    for (int y = 0; y < size; ++y)
      for (std::size_t c = 0; c < 3; ++c)
        for (int x = 0; x < size; ++x)
          pixels += raw(static_cast<float>(position_value(x, y, c)));
    exr.chunks.push_back(raw(0) + raw(0) + raw(level) + raw(level) +
                         raw(static_cast<std::int32_t>(pixels.size())) + pixels);
  }
  return exr;
}

/// Tries what a damaged file does to both readers. @return whether the picture was read
bool survives(const std::string& path, const std::string& bytes) {
  write_bytes(path, bytes);
  try {
    image::ExrMapSource(path).make(0, 0);
  } catch (const Error& error) {
    REQUIRE(error.kind() == ErrorKind::Input);
  }
  try {
    image::read_exr(path);
    return true;
  } catch (const Error& error) {
    REQUIRE(error.kind() == ErrorKind::Input);
    return false;
  }
}

} // namespace

TEST_CASE("the data window is placed in the display window", "[image]") {
  // Data columns 1 to 5, rows −1 to 1; the display window shows columns 0 to 3, rows 0 to 3.
  const ExrBytes exr =
      ExrBytes::scanlines({"B", "G", "R"}, box(1, -1, 5, 1), box(0, 0, 3, 3), position_value);
  const Image picture = read(exr.bytes());
  REQUIRE((picture.width == 4 && picture.height == 4));
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      const float blue = x >= 1 && y <= 1 ? static_cast<float>(position_value(x, y, 0)) : 0;
      CHECK(picture.at(x, y)[2] == blue);
      CHECK(picture.at(x, y)[0] == (blue > 0 ? blue + 2 : 0));
    }
  const TemporaryFolder folder;
  write_bytes(folder.file("a.exr"), exr.bytes());
  const image::ExrMapSource source(folder.file("a.exr"));
  CHECK(source.info().size == 4);
  CHECK(source.make(0, 0).rgb == picture.rgb);
}

TEST_CASE("windows that show nothing or take memory without pixels are refused", "[image]") {
  const auto windows = [](const std::string& data, const std::string& display) {
    ExrBytes exr = small();
    exr.attribute("dataWindow") = data;
    exr.attribute("displayWindow") = display;
    return refusal(exr.bytes());
  };
  CHECK_THAT(windows(box(0, 0, 3, 3), box(9, 9, 12, 12)),
             Catch::Contains("no pixels in its display"));
  CHECK_THAT(windows(box(0, 0, 3, 3), box(0, 0, 99999, 99999)), Catch::Contains("display window"));
  CHECK_THAT(windows(box(0, 0, 99999, 99999), box(0, 0, 3, 3)), Catch::Contains("at most 2^28"));
  CHECK_THAT(windows(box(0, 0, 16383, 8191), box(0, 0, 3, 3)), Catch::Contains("too short"));
  CHECK_THAT(windows(box(0, 0, 16383, 3), box(0, 0, 3, 3)), Catch::Contains("cannot hold"));
  constexpr std::int32_t low = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t high = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t a : {low, low / 2, 3, high / 2, high})
    for (const std::int32_t b : {low, low / 2, -1, 0, 2, high / 2, high}) {
      CHECK_FALSE(windows(box(a, 0, b, 3), box(0, 0, 3, 3)).empty());
      CHECK_FALSE(windows(box(0, a, 3, b), box(0, 0, 3, 3)).empty());
      windows(box(0, 0, 3, 3), box(a, b, a, b));
    }
}

TEST_CASE("channels are chosen by name", "[image]") {
  const auto first_pixel = [](const std::vector<std::string>& channels) {
    return read(ExrBytes::scanlines(channels, box(0, 0, 1, 1), box(0, 0, 1, 1), position_value)
                    .bytes())
        .at(0, 0);
  };
  CHECK((first_pixel({"A", "B", "G", "R", "Z"}) == Rgb(3, 2, 1)).all());
  CHECK(
      (first_pixel({"B", "G", "R", "diffuse.B", "diffuse.G", "diffuse.R"}) == Rgb(2, 1, 0)).all());
  CHECK((first_pixel({"Z", "albedo.X", "beauty.B", "beauty.G", "beauty.R"}) == Rgb(4, 3, 2)).all());
  CHECK((first_pixel({"A", "Y"}) == Rgb(1, 1, 1)).all());
  CHECK_THAT(named({"G", "R"}), Catch::Contains("G, R"));
  CHECK_THAT(named({"a.B", "a.G", "a.R", "b.B", "b.G", "b.R"}),
             Catch::Contains("several layers") && Catch::Contains("a.B, a.G, a.R, b.B, b.G, b.R"));
  CHECK_THAT(named({"Z"}), Catch::Contains("has no channels R, G, B or Y"));
  CHECK_THAT(named({"line\nbreak"}), Catch::Contains("line?break"));
  CHECK_THAT(named({"BY", "RY", "Y"}), Catch::Contains("luminance and chroma"));
}

TEST_CASE("an EXR that no picture can be made of is refused in a sentence", "[image]") {
  CHECK(refusal_of([](ExrBytes&) {}).empty());
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.version |= 0x800U; }), Catch::Contains("deep"));
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.version |= 0x1000U; }), Catch::Contains("multi-part"));
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.version |= 0x4000U; }), Catch::Contains("version"));
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.version = 1; }), Catch::Contains("version"));
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.attribute("type") = "deepscanline"; }),
             Catch::Contains("type deepscanline"));
  CHECK_THAT(refusal_of([](ExrBytes& e) {
               e.attribute("channels") = channel_list({"B", "G", "R"}, 0);
             }),
             Catch::Contains("integers"));
  CHECK_THAT(refusal_of([](ExrBytes& e) {
               e.attribute("channels") = channel_list({"B", "G", "R"}, 2, 2);
               e.chunks[0] = raw(0) + raw(24) + e.chunks[0].substr(8, 24);
               e.chunks[1] = raw(1) + raw(0);
               e.chunks[2] = raw(2) + raw(24) + e.chunks[2].substr(8, 24);
               e.chunks[3] = raw(3) + raw(0);
             }),
             Catch::Contains("subsampled"));
  const auto chromaticities = [](std::vector<float> xy) {
    return refusal_of([&](ExrBytes& e) {
      std::string value;
      for (const float v : xy)
        value += raw(v);
      e.attributes.push_back({"chromaticities", "chromaticities", value});
    });
  };
  CHECK(chromaticities({0.64F, 0.33F, 0.3F, 0.6F, 0.15F, 0.06F, 0.3127F, 0.329F}).empty());
  CHECK_THAT(chromaticities({0.708F, 0.292F, 0.17F, 0.797F, 0.131F, 0.046F, 0.3127F, 0.329F}),
             Catch::Contains("chromaticities"));
}

TEST_CASE("attributes of a wrong size, twice or missing are refused", "[image]") {
  for (const ExrAttribute& attribute : small().attributes) {
    INFO(attribute.name);
    CHECK_THAT(refusal_of([&](ExrBytes& e) { e.attributes.push_back(attribute); }),
               Catch::Contains(attribute.name + " occurs twice"));
    CHECK_THAT(refusal_of([&](ExrBytes& e) {
                 std::erase_if(e.attributes, [&](auto& a) { return a.name == attribute.name; });
               }),
               Catch::Contains("lacks the header attribute " + attribute.name));
    CHECK_FALSE(refusal_of([&](ExrBytes& e) { e.attribute(attribute.name) += '\0'; }).empty());
    CHECK_FALSE(refusal_of([&](ExrBytes& e) { e.attribute(attribute.name).pop_back(); }).empty());
  }
  const auto with = [](const std::string& type, const std::string& value) {
    return refusal_of([&](ExrBytes& e) { e.attributes.push_back({"extra", type, value}); });
  };
  CHECK(with("string", "text").empty());
  CHECK(with("unknown", "anything").empty());
  CHECK(with("preview", raw(1) + raw(1) + "rgba").empty());
  CHECK(with("stringvector", raw(1) + "a" + raw(2) + "bc").empty());
  CHECK_THAT(with("int", "12345678"), Catch::Contains("type int has 8 bytes, must have 4"));
  CHECK_FALSE(with("preview", raw(0x7fffffff) + raw(0x7fffffff) + "rgba").empty());
  CHECK_FALSE(with("preview", raw(1 << 16) + raw(1 << 16)).empty());
  CHECK_FALSE(with("stringvector", raw(0x7fffffff) + "a").empty());
  CHECK_FALSE(with("floatvector", "12345").empty());
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.attribute(std::string(256, 'n')) = "x"; }),
             Catch::Contains("255"));
  CHECK_FALSE(refusal_of([](ExrBytes& e) {
                e.attributes.push_back({"chunkCount", "int", raw(5)});
              }).empty());
}

TEST_CASE("chunks that are not where and as long as they must be are refused", "[image]") {
  // Shorter than its pixels, by which a reader would run past the file's end.
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.chunks[3] = raw(3) + raw(8) + "12345678"; }),
             Catch::Contains("chunk 3 has 8 bytes, which cannot hold its 48 bytes"));
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.chunks[3].pop_back(); }),
             Catch::Contains("chunk 3 does not end within the file"));
  CHECK_THAT(refusal_of([](ExrBytes& e) { std::swap(e.chunks[0], e.chunks[1]); }),
             Catch::Contains("chunk 0 is of another place"));
  CHECK_THAT(refusal_of([](ExrBytes& e) { e.chunks.pop_back(); }), Catch::Contains("chunk"));
  for (const std::int32_t size : {-1, 0, 47, 49, std::numeric_limits<std::int32_t>::max(),
                                  std::numeric_limits<std::int32_t>::min()})
    CHECK_FALSE(refusal_of([&](ExrBytes& e) { e.chunks[1].replace(4, 4, raw(size)); }).empty());
  const ExrBytes exr = small();
  for (const std::uint64_t offset :
       {std::uint64_t{0}, std::uint64_t{8}, exr.header().size() + 32 - 1, exr.bytes().size() - 4,
        exr.bytes().size(), ~std::uint64_t{0}, std::uint64_t{1} << 63U}) {
    std::string bytes = exr.bytes();
    bytes.replace(exr.header().size(), 8, raw(offset));
    CHECK_FALSE(refusal(bytes).empty());
  }
  // Compressed: 1 byte of deflate cannot hold 3 MB of pixels.
  CHECK_THAT(refusal_of([](ExrBytes& e) {
               e.attribute("compression") = "\3";
               e.attribute("dataWindow") = box(0, 0, 16383, 15);
               e.chunks = {raw(0) + raw(1) + "x"};
             }),
             Catch::Contains("cannot hold"));
}

TEST_CASE("tiles and their levels are checked", "[image]") {
  const ExrBytes exr = mip_mapped();
  CHECK(read(exr.bytes()).rgb == read(small().bytes()).rgb);
  const auto tiles = [&](std::uint32_t width, std::uint32_t height, char mode) {
    ExrBytes changed = exr;
    changed.attribute("tiles") = raw(width) + raw(height) + mode;
    return refusal(changed.bytes());
  };
  CHECK(tiles(4, 4, 1).empty());
  CHECK(tiles(64, 64, 1).empty());
  CHECK_THAT(tiles(1U << 14U, 1U << 14U, 1), Catch::Contains("too large"));
  CHECK_THAT(tiles(1, 1U << 30U, 1), Catch::Contains("too large"));
  for (const std::uint32_t side : {0U, 1U, 3U, 0x7fffffffU, 0x80000000U, 0xffffffffU}) {
    CHECK_FALSE(tiles(side, 4, 1).empty());
    CHECK_FALSE(tiles(4, side, 1).empty());
  }
  for (const int mode : {2, 3, 0x12, 0x21, 0xff})
    CHECK_FALSE(tiles(4, 4, static_cast<char>(mode)).empty());
  ExrBytes cut = exr;
  cut.chunks.pop_back();
  CHECK_FALSE(refusal(cut.bytes()).empty());
}

TEST_CASE("a picture of few bytes is read if they hold all of its pixels", "[image]") {
  const TemporaryFolder folder;
  image::write_exr(folder.file("black.exr"), Image(1024, 512));
  CHECK(std::filesystem::file_size(folder.file("black.exr")) < 20000);
  const Image back = image::read_exr(folder.file("black.exr"));
  CHECK((back.width == 1024 && back.height == 512));
  CHECK(std::count(back.rgb.begin(), back.rgb.end(), 0.0F) == 3 * 1024 * 512);
}

TEST_CASE("a damaged EXR is read or refused, never anything else", "[image]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("damaged.exr");
  Image ramp(8, 8);
  for (std::size_t i = 0; i < ramp.rgb.size(); ++i)
    ramp.rgb[i] = static_cast<float>(i % 7);
  image::write_exr(folder.file("ramp.exr"), ramp);
  for (const std::string& whole :
       {read_bytes(folder.file("ramp.exr")), small().bytes(), mip_mapped().bytes()}) {
    REQUIRE(survives(path, whole));
    for (std::size_t length = 0; length < whole.size(); length += 16)
      REQUIRE_FALSE(survives(path, whole.substr(0, length)));
    int refused = 0;
    for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 11) {
      std::string damaged = whole;
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
      refused += survives(path, damaged) ? 0 : 1;
    }
    CHECK(refused > 30);
    for (std::size_t at = 4; at + 4 <= whole.size(); at += 4)
      for (const std::int32_t value : {-1, 1 << 28, std::numeric_limits<std::int32_t>::max()}) {
        std::string damaged = whole;
        survives(path, damaged.replace(at, 4, raw(value)));
      }
  }
}
