// OpenEXR files of many kinds, made here, read as probes.

#include "probe_files.h"

#include <probe/read_probe.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTiledOutputFile.h>

using namespace haarlight;
using namespace haarlight::probe;
using haarlight::testing::bytes_of_file;
using haarlight::testing::error_of;
using haarlight::testing::ProbeFolder;
using Imath::Box2i;
using Imath::V2i;

namespace {

/// A channel of constant value, in a part.
struct Channel {
  std::string name;
  float value;
};

using Part = std::vector<Channel>;

constexpr int width = 8;
constexpr int height = 4;

Imf::Header make_header(const Part& part, Imf::PixelType type = Imf::FLOAT) {
  Imf::Header header(width, height);
  for (const Channel& channel : part)
    header.channels().insert(channel.name, Imf::Channel(type));
  return header;
}

/// Values that vary over the image: `value` + x + 10 y, in window coordinates.
struct Planes {
  std::vector<std::vector<float>> planes;
  Imf::FrameBuffer buffer;

  Planes(const Part& part, const Box2i& window) {
    const int columns = window.max.x - window.min.x + 1;
    const int rows = window.max.y - window.min.y + 1;
    planes.reserve(part.size());
    for (const Channel& channel : part) {
      auto& plane = planes.emplace_back();
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
          plane.push_back(channel.value + static_cast<float>(x + window.min.x) +
                          10 * static_cast<float>(y + window.min.y));
      buffer.insert(channel.name,
                    Imf::Slice::Make(Imf::FLOAT, plane.data(), window, sizeof(float),
                                     sizeof(float) * static_cast<std::size_t>(columns)));
    }
  }
};

std::string write(const std::string& path, const Part& part, Imf::Header header) {
  const Planes planes(part, header.dataWindow());
  Imf::OutputFile file(path.c_str(), header);
  file.setFrameBuffer(planes.buffer);
  file.writePixels(planes.buffer.begin() == planes.buffer.end()
                       ? 0
                       : header.dataWindow().max.y - header.dataWindow().min.y + 1);
  return path;
}

std::string write(const std::string& path, const Part& part) {
  return write(path, part, make_header(part));
}

std::string write_parts(const std::string& path,
                        const std::vector<std::pair<std::string, Part>>& parts) {
  std::vector<Imf::Header> headers;
  for (const auto& [name, part] : parts) {
    headers.push_back(make_header(part));
    headers.back().setName(name);
    headers.back().setType(Imf::SCANLINEIMAGE);
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), static_cast<int>(headers.size()));
  for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
    const Planes planes(parts[static_cast<std::size_t>(i)].second, headers[0].dataWindow());
    Imf::OutputPart output(file, i);
    output.setFrameBuffer(planes.buffer);
    output.writePixels(height);
  }
  return path;
}

/// The pixel at (2, 1) without what varies: the values of the channels that were read.
Rgb channel_values(const std::string& path, const ImageChoice& choice = {}) {
  return read_image(path, choice).image.at(2, 1) - 12;
}

bool is(const Rgb& colour, float r, float g, float b) {
  return (colour - Rgb(r, g, b)).abs().maxCoeff() < 1e-4F;
}

std::string refusal(const std::string& path, const ImageChoice& choice = {}) {
  return error_of([&] { read_image(path, choice); });
}

const Part plain = {{"R", 100}, {"G", 200}, {"B", 300}};
const Part beauty = {{"beauty.R", 100}, {"beauty.G", 200}, {"beauty.B", 300}};
const Part depth = {{"Z", 7}};

Part joined(Part a, const Part& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

} // namespace

TEST_CASE("Channels of OpenEXR are chosen by name", "[exr_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.exr");
  const Part alternatives[] = {plain,
                               beauty,
                               joined(depth, beauty),
                               joined(plain, beauty),
                               {{"r", 100}, {"g", 200}, {"b", 300}},
                               {{"Red", 100}, {"green", 200}, {"BLUE", 300}},
                               {{"A.b.R", 100}, {"A.b.G", 200}, {"A.b.B", 300}, {"A.R", 5}},
                               joined({{"Y", 5}, {"A", 1}, {"AA", 2}}, plain)};
  for (const Part& part : alternatives)
    CHECK(is(channel_values(write(path, part)), 100, 200, 300));
  CHECK(is(channel_values(write(path, {{"Y", 50}, {"A", 1}})), 50, 50, 50));
  CHECK(is(channel_values(write(path, {{"Y", 50}, {"Z", 1}})), 50, 50, 50));
  CHECK(is(channel_values(write(path, {{"grey.Y", 50}, {"Z", 1}})), 50, 50, 50));
}

TEST_CASE("Ambiguous or missing colours of OpenEXR are refused with a list", "[exr_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.exr");
  const Part albedo = {{"albedo.R", 1}, {"albedo.G", 2}, {"albedo.B", 3}};
  write(path, joined(albedo, beauty));
  CHECK_THAT(refusal(path), Catch::Contains("albedo") && Catch::Contains("beauty"));
  CHECK(is(channel_values(path, {"beauty", ""}), 100, 200, 300));
  CHECK(is(channel_values(path, {"Albedo", ""}), 1, 2, 3));
  CHECK_THAT(refusal(path, {"diffuse", ""}), Catch::Contains("no layer 'diffuse'"));
  CHECK_THAT(refusal(path, {"", "3"}), Catch::Contains("no part '3'"));
  CHECK_THAT(refusal(write(path, {{"R", 1}, {"G", 1}})), Catch::Contains("channels G, R"));
  CHECK_THAT(refusal(write(path, depth)), Catch::Contains("channels Z"));
  CHECK_THAT(refusal(write(path, {{"P.X", 1}, {"P.Y", 1}, {"P.Z", 1}})), Catch::Contains("'P'"));
  CHECK_THAT(refusal(write(path, joined(plain, {{"r", 1}}))), Catch::Contains("letter case"));
}

TEST_CASE("All parts of OpenEXR are searched", "[exr_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.exr");
  CHECK(is(channel_values(write_parts(path, {{"z", depth}, {"rgb", plain}})), 100, 200, 300));
  CHECK(is(channel_values(write_parts(path, {{"rgb", plain}, {"z", depth}})), 100, 200, 300));
  CHECK(is(channel_values(write_parts(path, {{"z", depth}, {"l", beauty}})), 100, 200, 300));
  const Part other = {{"R", 1}, {"G", 2}, {"B", 3}};
  write_parts(path, {{"first", other}, {"second", plain}});
  CHECK_THAT(refusal(path), Catch::Contains("'first'") && Catch::Contains("'second'"));
  CHECK(is(channel_values(path, {"", "1"}), 100, 200, 300));
  CHECK(is(channel_values(path, {"", "first"}), 1, 2, 3));
  CHECK(is(channel_values(path, {"second", ""}), 100, 200, 300));
  CHECK_THAT(refusal(path, {"", "2"}), Catch::Contains("0 'first', 1 'second'"));
  CHECK_THAT(refusal(path, {"", "-1"}), Catch::Contains("no part"));
}

TEST_CASE("The data window is placed in the display window", "[exr_files]") {
  const ProbeFolder folder;
  const Box2i windows[] = {{{2, 1}, {5, 2}}, {{-3, -2}, {10, 6}}, {{-2, 1}, {3, 9}},
                           {{7, 3}, {7, 3}}, {{0, 0}, {7, 3}},    {{0, 2}, {7, 3}}};
  for (const V2i& origin : {V2i(0, 0), V2i(-5, 3)})
    for (const Box2i& window : windows) {
      Imf::Header header = make_header(plain);
      header.displayWindow() = Box2i(origin, origin + V2i(width - 1, height - 1));
      header.dataWindow() = Box2i(window.min + origin, window.max + origin);
      const auto image = read_image(write(folder.path("a.exr"), plain, header)).image;
      REQUIRE((image.width == width && image.height == height));
      bool right = true;
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const float shift =
              static_cast<float>(x + origin.x) + 10 * static_cast<float>(y + origin.y);
          const Rgb wanted =
              window.intersects(V2i(x, y)) ? Rgb(Rgb(100, 200, 300) + shift) : Rgb(Rgb::Zero());
          right = right && (image.at(x, y) == wanted).all();
        }
      CHECK(right);
    }
  Imf::Header outside = make_header(plain);
  outside.dataWindow() = Box2i(V2i(20, 20), V2i(27, 23));
  CHECK_THAT(refusal(write(folder.path("a.exr"), plain, outside)), Catch::Contains("outside"));
}

TEST_CASE("Pixel types, compressions and tiles of OpenEXR", "[exr_files]") {
  const ProbeFolder folder;
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                 Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    Imf::Header header = make_header(plain);
    header.compression() = compression;
    header.lineOrder() = Imf::DECREASING_Y;
    Imf::Header increasing = make_header(plain);
    increasing.compression() = compression;
    CHECK(is(channel_values(write(folder.path("a.exr"), plain, increasing)), 100, 200, 300));
  }
  Imf::Header tiled = make_header(plain);
  tiled.setTileDescription(Imf::TileDescription(3, 3, Imf::MIPMAP_LEVELS));
  const Planes planes(plain, tiled.dataWindow());
  {
    Imf::TiledOutputFile file(folder.path("tiled.exr").c_str(), tiled);
    file.setFrameBuffer(planes.buffer);
    for (int level = 0; level < file.numLevels(); ++level)
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
  }
  CHECK(is(channel_values(folder.path("tiled.exr")), 100, 200, 300));
}

TEST_CASE("Luminance and chroma are decoded", "[exr_files]") {
  const ProbeFolder folder;
  const std::string path = folder.path("a.exr");
  {
    const std::vector<Imf::Rgba> pixels(width * height, Imf::Rgba(0.5F, 0.25F, 0.125F));
    Imf::RgbaOutputFile file(path.c_str(), width, height, Imf::WRITE_YC);
    file.setFrameBuffer(pixels.data(), 1, width);
    file.writePixels(height);
  }
  const Rgb colour = read_image(path).image.at(3, 2);
  CHECK((colour - Rgb(0.5F, 0.25F, 0.125F)).abs().maxCoeff() < 4e-3F); // halves
}

TEST_CASE("Chromaticities of OpenEXR are obeyed", "[exr_files]") {
  const ProbeFolder folder;
  Imf::Header header = make_header(plain);
  Imf::addChromaticities(header, Imf::Chromaticities({0.708F, 0.292F}, {0.170F, 0.797F},
                                                     {0.131F, 0.046F}, {0.3127F, 0.3290F}));
  const auto loaded = read_image(write(folder.path("a.exr"), plain, header));
  const Rgb colour = loaded.image.at(0, 0); // 100, 200, 300 of Rec. 2020
  CHECK(colour[0] == Approx(1.66050 * 100 - 0.58764 * 200 - 0.07286 * 300).epsilon(2e-3));
  CHECK(colour[1] == Approx(-0.12455 * 100 + 1.13290 * 200 - 0.00835 * 300).epsilon(2e-3));
  CHECK(colour[2] == Approx(-0.01815 * 100 - 0.10058 * 200 + 1.11873 * 300).epsilon(2e-3));
  CHECK(loaded.notes.size() == 1);
  Imf::Header same = make_header(plain);
  Imf::addChromaticities(same, Imf::Chromaticities());
  const auto unchanged = read_image(write(folder.path("a.exr"), plain, same));
  CHECK((unchanged.image.at(0, 0) == Rgb(100, 200, 300)).all());
  CHECK(unchanged.notes.empty());
  Imf::Header line = make_header(plain);
  Imf::addChromaticities(line, Imf::Chromaticities({0.1F, 0.1F}, {0.2F, 0.2F}, {0.3F, 0.3F}));
  CHECK_THAT(refusal(write(folder.path("a.exr"), plain, line)), Catch::Contains("chromaticities"));
}

TEST_CASE("OpenEXR files that claim more than they hold are refused", "[exr_files]") {
  const ProbeFolder folder;
  const std::string whole = bytes_of_file(write(folder.path("a.exr"), plain));
  for (const std::size_t count : {4U, 20U, 200U, 300U})
    CHECK_THAT(refusal(folder.write("cut.exr", whole.substr(0, count))),
               Catch::Contains("cut.exr"));
  CHECK_FALSE(refusal(folder.write("cut.exr", whole.substr(0, whole.size() - 10))).empty());
  for (const int side : {16000, 100000, 2000000000}) {
    std::string huge = whole;
    for (const char* name : {"dataWindow", "displayWindow"}) {
      const std::size_t box = huge.find(name) + std::string(name).size() + 1 + 6 + 4;
      const std::int32_t last = side;
      huge.replace(box + 8, 4, reinterpret_cast<const char*>(&last), 4);
      huge.replace(box + 12, 4, reinterpret_cast<const char*>(&last), 4);
    }
    CHECK_THAT(refusal(folder.write("huge.exr", huge)), Catch::Contains("huge.exr"));
  }
}
