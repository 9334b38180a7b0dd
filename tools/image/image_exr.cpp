#include <image/image_exr.h>

#include <image/exr_header.h>
#include <image/exr_pixels.h>
#include <image/exr_stream.h>
#include <image/map_set_exr.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <cassert>

namespace haarlight::image {
namespace {

Imf::Header header_of(const ExrImage& image) {
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.lineOrder() = Imf::INCREASING_Y;
  for (const ExrChannel& channel : image.channels)
    header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
  for (const auto& [name, text] : image.texts)
    header.insert(name, Imf::StringAttribute(text));
  for (const auto& [name, number] : image.numbers)
    header.insert(name, Imf::DoubleAttribute(number));
  for (const auto& [name, number] : image.integers)
    header.insert(name, Imf::IntAttribute(number));
  return header;
}

/// OpenEXR wants writable memory even where it only reads.
Imf::Slice slice_of(const float* first, int stride, const Imath::V2i& origin, int width,
                    int height) {
  const std::size_t step = sizeof(float) * static_cast<std::size_t>(stride);
  return Imf::Slice::Make(Imf::FLOAT, first, origin, width, height, step,
                          step * static_cast<std::size_t>(width));
}

Imf::FrameBuffer frame_of(const ExrImage& image) {
  Imf::FrameBuffer frame;
  for (const ExrChannel& channel : image.channels)
    frame.insert(channel.name, slice_of(channel.first, channel.stride, Imath::V2i(0, 0),
                                        image.width, image.height));
  return frame;
}

} // namespace

void write_exr(const std::string& path, const ExrImage& image) {
  assert(image.width > 0 && image.height > 0 && !image.channels.empty());
  const int threads = start_exr_threads();
  OutputFile file(path);
  ExrOutputStream stream(file);
  {
    Imf::OutputFile output(stream, header_of(image), threads);
    output.setFrameBuffer(frame_of(image));
    output.writePixels(image.height);
  }
  stream.rethrow();
  commit_exr(file);
}

void write_exr(const std::string& path, const Picture& picture) {
  const float* first = picture.rgb.data();
  ExrImage image;
  image.width = picture.width;
  image.height = picture.height;
  image.channels = {{"R", first, 3}, {"G", first + 1, 3}, {"B", first + 2, 3}};
  write_exr(path, image);
}

Picture read_exr(const std::string& path) {
  const InputFile file(path);
  return read_rgb(file, read_exr_header(file));
}

} // namespace haarlight::image
