// Images of the accepted formats against OpenImageIO, an independent reader and writer of all of
// them but PFM.

#include <probe/read_probe.h>

#include "temporary_folder.h"

#include <OpenImageIO/imageio.h>

#include <catch2/catch.hpp>

#include <cmath>
#include <memory>

using namespace haarlight::probe;

namespace {

struct Format {
  const char* name; ///< its ending decides the format
  OIIO::TypeDesc::BASETYPE type;
  const char* compression;
  int tile = 0; ///< pixels along the side of a tile, 0 = scanlines
};

constexpr int width = 37;
constexpr int height = 19;

/// A smooth image in [0.02, 1] with a different gradient in each channel.
std::vector<float> gradient() {
  std::vector<float> rgb;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float u = static_cast<float>(x) / width;
      const float v = static_cast<float>(y) / height;
      rgb.insert(rgb.end(), {0.02F + 0.9F * u, 0.05F + 0.6F * v, 0.1F + 0.5F * u * v});
    }
  return rgb;
}

void write(const std::string& path, const Format& format) {
  OIIO::ImageSpec spec(width, height, 3, format.type);
  if (format.compression != nullptr)
    spec.attribute("compression", format.compression);
  spec.tile_width = spec.tile_height = format.tile;
  const auto output = OIIO::ImageOutput::create(path);
  REQUIRE(output);
  REQUIRE(output->open(path, spec));
  const std::vector<float> rgb = gradient();
  REQUIRE(output->write_image(OIIO::TypeDesc::FLOAT, rgb.data()));
  REQUIRE(output->close());
}

float linear(float v) { return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F); }

/// The pixels as OpenImageIO reads them, made linear if it states that they are sRGB.
std::vector<float> read_by_openimageio(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  REQUIRE(input);
  const OIIO::ImageSpec& spec = input->spec();
  REQUIRE((spec.width == width && spec.height == height && spec.nchannels == 3));
  std::vector<float> rgb(3 * width * height);
  REQUIRE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, rgb.data()));
  if (spec.get_string_attribute("oiio:ColorSpace") == "sRGB" ||
      spec.format == OIIO::TypeDesc::UINT8)
    for (float& v : rgb)
      v = linear(v);
  return rgb;
}

} // namespace

TEST_CASE("Images are read as OpenImageIO reads them", "[openimageio]") {
  const auto format = GENERATE(values<Format>({{"none.exr", OIIO::TypeDesc::FLOAT, "none"},
                                               {"rle.exr", OIIO::TypeDesc::HALF, "rle"},
                                               {"zips.exr", OIIO::TypeDesc::HALF, "zips"},
                                               {"zip.exr", OIIO::TypeDesc::FLOAT, "zip"},
                                               {"piz.exr", OIIO::TypeDesc::HALF, "piz"},
                                               {"pxr24.exr", OIIO::TypeDesc::FLOAT, "pxr24"},
                                               {"b44.exr", OIIO::TypeDesc::HALF, "b44"},
                                               {"b44a.exr", OIIO::TypeDesc::HALF, "b44a"},
                                               {"dwaa.exr", OIIO::TypeDesc::HALF, "dwaa"},
                                               {"dwab.exr", OIIO::TypeDesc::FLOAT, "dwab"},
                                               {"tiled.exr", OIIO::TypeDesc::HALF, "zip", 16},
                                               {"float.tif", OIIO::TypeDesc::FLOAT, "none"},
                                               {"float-zip.tif", OIIO::TypeDesc::FLOAT, "zip"},
                                               {"half.tif", OIIO::TypeDesc::HALF, "lzw"},
                                               {"tiled.tif", OIIO::TypeDesc::FLOAT, "zip", 16},
                                               {"8bit.tif", OIIO::TypeDesc::UINT8, "lzw"},
                                               {"8bit.png", OIIO::TypeDesc::UINT8, nullptr},
                                               {"8bit.jpg", OIIO::TypeDesc::UINT8, nullptr},
                                               {"rgbe.hdr", OIIO::TypeDesc::FLOAT, nullptr}}));
  CAPTURE(format.name);
  const TemporaryFolder folder;
  const std::string path = folder.file(format.name);
  write(path, format);
  const std::vector<float> expected = read_by_openimageio(path);
  const haarlight::Image image = read_image(path).image;
  REQUIRE((image.width == width && image.height == height));
  float worst = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    worst = std::max(worst, std::abs(image.rgb[i] - expected[i]));
  CHECK(worst < 1e-5F);
}
