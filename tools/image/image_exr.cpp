#include <image/image_exr.h>

#include <image/exr_header.h>
#include <image/exr_stream.h>
#include <image/map_set_exr.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
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

constexpr std::int64_t most_pixels = std::int64_t{1} << 28;

Imath::V2i picture_size(const Imath::Box2i& window, const std::string& path) {
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (width < 1 || height < 1 || width > most_pixels / height)
    throw_input_error(path, "is of " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels, at most 2^28 in all are read");
  return {static_cast<int>(width), static_cast<int>(height)};
}

Picture read_picture(Imf::InputFile& file, const std::string& path) {
  const Imath::Box2i window = file.header().dataWindow();
  const Imath::V2i size = picture_size(window, path);
  if (!file.isComplete())
    throw_input_error(path, "is truncated: pixels are missing");
  const Imf::ChannelList& channels = file.header().channels();
  const bool grey = channels.findChannel("R") == nullptr;
  Picture picture(size.x, size.y);
  const char* const names[3] = {"R", "G", "B"};
  Imf::FrameBuffer frame;
  for (int c = 0; c < (grey ? 1 : 3); ++c) {
    const Imf::Channel* channel = channels.findChannel(grey ? "Y" : names[c]);
    if (channel == nullptr || channel->xSampling != 1 || channel->ySampling != 1)
      throw_input_error(path, "has no whole channels R, G, B or Y");
    frame.insert(grey ? "Y" : names[c],
                 slice_of(picture.rgb.data() + c, 3, window.min, size.x, size.y));
  }
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  for (std::size_t i = 0; grey && i < picture.rgb.size(); i += 3)
    picture.rgb[i + 2] = picture.rgb[i + 1] = picture.rgb[i];
  return picture;
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
  read_exr_header(file);
  return with_input_errors(path, [&] {
    ExrInputStream stream(file);
    Imf::InputFile input(stream, 0);
    return read_picture(input, path);
  });
}

} // namespace haarlight::image
