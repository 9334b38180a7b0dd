// OpenEXR files: the colours of one layer, placed in the display window.

#include "decoder.h"
#include "exr_channels.h"
#include "file/colour_space.h"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTileDescriptionAttribute.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <thread>

namespace haarlight::probe::reader {
namespace {

using Imath::Box2i;

/// Longest side: tables of offsets grow with it, before anything else of the file is known.
constexpr int longest_side = 1 << 17;

constexpr const char* stream_name = "input";

class MemoryStream : public Imf::IStream {
public:
  explicit MemoryStream(std::span<const std::byte> bytes) : IStream(stream_name), m_bytes(bytes) {}

  bool read(char to[], int count) override {
    const auto wanted = static_cast<std::size_t>(count);
    if (count < 0 || m_position > m_bytes.size() || wanted > m_bytes.size() - m_position)
      throw Refusal("is cut short: it ends at byte " + std::to_string(m_bytes.size()));
    std::memcpy(to, m_bytes.data() + m_position, wanted);
    m_position += wanted;
    return m_position < m_bytes.size();
  }
  std::uint64_t tellg() override { return m_position; }
  void seekg(std::uint64_t position) override { m_position = position; }

private:
  std::span<const std::byte> m_bytes;
  std::uint64_t m_position = 0;
};

std::uint64_t width_of(const Box2i& box) {
  return static_cast<std::uint64_t>(std::int64_t{box.max.x} - box.min.x + 1);
}
std::uint64_t height_of(const Box2i& box) {
  return static_cast<std::uint64_t>(std::int64_t{box.max.y} - box.min.y + 1);
}

/// Raw bytes that a byte of the file can stand for: 64 is a run of 127 equal bytes in two, 1032 the
/// limit of deflate, PXR24 drops a byte of four before it, B44A packs 16 halves into 3 bytes. PIZ
/// codes 256 equal values in 10 bits. DWA deflates what is one value per 8x8 block.
std::uint64_t largest_ratio(Imf::Compression compression) {
  switch (compression) {
  case Imf::NO_COMPRESSION:
    return 1;
  case Imf::RLE_COMPRESSION:
    return 64;
  case Imf::ZIPS_COMPRESSION:
  case Imf::ZIP_COMPRESSION:
  case Imf::PIZ_COMPRESSION:
    return 1032;
  case Imf::PXR24_COMPRESSION:
    return 1376;
  case Imf::B44_COMPRESSION:
  case Imf::B44A_COMPRESSION:
    return 11;
  default:
    return 128 * 1032;
  }
}

std::uint64_t raw_bytes(const Imf::Header& header) {
  std::uint64_t bytes_of_pixel = 0;
  std::uint64_t subsampled = 0;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    const std::uint64_t bytes = i.channel().type == Imf::HALF ? 2 : 4;
    if (i.channel().xSampling == 1 && i.channel().ySampling == 1)
      bytes_of_pixel += bytes;
    else
      subsampled += bytes / static_cast<std::uint64_t>(i.channel().xSampling) /
                    static_cast<std::uint64_t>(i.channel().ySampling);
  }
  return width_of(header.dataWindow()) * height_of(header.dataWindow()) *
         (bytes_of_pixel + subsampled);
}

/// A small data window may lie in a large display window, but a file of a few pixels should not
/// fill the memory: at most so many pixels of the display window per pixel, above an image of 4 MP.
constexpr std::uint64_t display_per_pixel = 4096;
constexpr std::uint64_t small_display = std::uint64_t{1} << 22;

void check_windows(const Imf::Header& header) {
  const Box2i& data = header.dataWindow();
  const Box2i& display = header.displayWindow();
  check_pixels(width_of(data), height_of(data));
  check_pixels(width_of(display), height_of(display));
  const std::uint64_t shown = width_of(display) * height_of(display);
  if (shown > small_display && shown / display_per_pixel > width_of(data) * height_of(data))
    throw Refusal("has a display window of " + std::to_string(width_of(display)) + " x " +
                  std::to_string(height_of(display)) + " pixels around a data window of only " +
                  std::to_string(width_of(data)) + " x " + std::to_string(height_of(data)));
}

const Imf::Channel& channel(const Imf::Header& header, const std::string& name) {
  return *header.channels().findChannel(name.c_str());
}

bool is_full(const Imf::Channel& c) { return c.xSampling == 1 && c.ySampling == 1; }

Image read_colours(Imf::MultiPartInputFile& file, const ExrChannels& channels) {
  const Imf::Header& header = file.header(channels.part);
  const Box2i& window = header.dataWindow();
  const bool grey = channels.red.empty();
  const std::string names[3] = {grey ? channels.luminance : channels.red,
                                grey ? channels.luminance : channels.green,
                                grey ? channels.luminance : channels.blue};
  Image image(static_cast<int>(width_of(window)), static_cast<int>(height_of(window)));
  Imf::FrameBuffer buffer;
  constexpr std::size_t stride = 3 * sizeof(float);
  for (std::size_t c = 0; c < (grey ? 1 : 3); ++c) {
    if (!is_full(channel(header, names[c])))
      throw Refusal("has the subsampled channel " + names[c] +
                    ", only luminance with chroma may be subsampled");
    buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, image.rgb.data() + c, window, stride,
                                             width_of(window) * stride));
  }
  Imf::InputPart part(file, channels.part);
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  if (grey)
    for (std::size_t i = 0; i < image.rgb.size(); i += 3)
      image.rgb[i + 1] = image.rgb[i + 2] = image.rgb[i];
  return image;
}

/// Luminance and subsampled chroma, by the library's own reconstruction, in half precision.
Image read_luminance_chroma(const Task& task, const Imf::MultiPartInputFile& file,
                            const ExrChannels& channels) {
  const Imf::Header& header = file.header(channels.part);
  const auto chroma = [&](const std::string& name) {
    return channel(header, name).xSampling == 2 && channel(header, name).ySampling == 2;
  };
  const std::string prefix = channels.layer.empty() ? "" : channels.layer + '.';
  if (file.parts() > 1 || !is_full(channel(header, channels.luminance)) ||
      channels.luminance != prefix + 'Y' || channels.red_chroma != prefix + "RY" ||
      channels.blue_chroma != prefix + "BY" || !chroma(channels.red_chroma) ||
      !chroma(channels.blue_chroma))
    throw Refusal("has luminance and chroma channels, which are read from files of one part only, "
                  "as Y, RY and BY with chroma subsampled 2 x 2");
  MemoryStream stream(task.bytes);
  Imf::RgbaInputFile input(stream, channels.layer);
  const Box2i& window = header.dataWindow();
  const std::size_t width = width_of(window);
  std::vector<Imf::Rgba> row(width);
  Image image(static_cast<int>(width), static_cast<int>(height_of(window)));
  for (int y = window.min.y; y <= window.max.y; ++y) {
    input.setFrameBuffer(row.data() - window.min.x, 1, 0);
    input.readPixels(y);
    for (std::size_t x = 0; x < width; ++x)
      image.set(static_cast<int>(x), y - window.min.y, {row[x].r, row[x].g, row[x].b});
  }
  return image;
}

/// Moves the data window to its place in the display window; black outside, cropped where larger.
Image place(Image data, const Box2i& data_window, const Box2i& display) {
  if (data_window == display)
    return data;
  Image result(static_cast<int>(width_of(display)), static_cast<int>(height_of(display)));
  const int x_begin = std::max(data_window.min.x, display.min.x);
  const int x_last = std::min(data_window.max.x, display.max.x);
  const int y_begin = std::max(data_window.min.y, display.min.y);
  const int y_last = std::min(data_window.max.y, display.max.y);
  if (x_begin > x_last || y_begin > y_last)
    throw Refusal("has a data window outside the display window, so nothing of it is shown");
  const std::size_t count = 3 * (static_cast<std::size_t>(x_last - x_begin) + 1);
  for (int y = y_begin; y <= y_last; ++y)
    std::copy_n(data.rgb.data() + data.offset(x_begin - data_window.min.x, y - data_window.min.y),
                count,
                result.rgb.data() + result.offset(x_begin - display.min.x, y - display.min.y));
  return result;
}

std::optional<Chromaticities> chromaticities_of(const Imf::Header& header) {
  if (Imf::hasChromaticities(header)) {
    const Imf::Chromaticities c = Imf::chromaticities(header);
    const auto xy = [](const Imath::V2f& v) { return Eigen::Vector2d(v.x, v.y); };
    return Chromaticities{xy(c.red), xy(c.green), xy(c.blue), xy(c.white)};
  }
  const auto* aces = header.findTypedAttribute<Imf::IntAttribute>("acesImageContainerFlag");
  if (aces != nullptr && aces->value() == 1)
    return aces_chromaticities();
  return std::nullopt;
}

/// whiteLuminance and adoptedNeutral are left alone: they scale a display, not the radiance.
void convert_primaries(const Imf::Header& header, DecodedImage& picture) {
  const auto primaries = chromaticities_of(header);
  if (!primaries)
    return;
  const auto matrix = rec709_from_rgb(*primaries);
  if (!matrix)
    throw Refusal("has chromaticities that span no colour space");
  if (matrix->isIdentity())
    return;
  for (std::size_t i = 0; i < picture.image.rgb.size(); i += 3) {
    Eigen::Map<Eigen::Vector3f> rgb(picture.image.rgb.data() + i);
    rgb = (*matrix * rgb.cast<double>()).cast<float>();
  }
  picture.notes.emplace_back(
      "colours were converted to Rec. 709 from the primaries of its chromaticities");
}

DecodedImage read_file(const Task& task) {
  Imf::Header::setMaxImageSize(longest_side, longest_side);
  Imf::Header::setMaxTileSize(longest_side, longest_side);
  MemoryStream stream(task.bytes);
  Imf::MultiPartInputFile file(stream, 0);
  const ExrChannels channels = find_colours(file, task.choice);
  const Imf::Header& header = file.header(channels.part);
  check_windows(header);
  check_file_size(task, raw_bytes(header), largest_ratio(header.compression()));
  const std::uint64_t pixels = width_of(header.dataWindow()) * height_of(header.dataWindow());
  const std::uint64_t shown = width_of(header.displayWindow()) * height_of(header.displayWindow());
  constexpr std::uint64_t for_buffers = std::uint64_t{512} << 20; // and for stacks of threads
  allow_memory(for_buffers + 12 * (pixels + shown) + 3 * raw_bytes(header));
  Imf::setGlobalThreadCount(static_cast<int>(std::min(std::thread::hardware_concurrency(), 4U)));

  const bool chroma =
      channels.red.empty() && !channels.red_chroma.empty() && !channels.blue_chroma.empty();
  DecodedImage picture;
  Image data = chroma ? read_luminance_chroma(task, file, channels) : read_colours(file, channels);
  picture.image = place(std::move(data), header.dataWindow(), header.displayWindow());
  if (chroma || !channels.red.empty())
    convert_primaries(header, picture);
  if (!channels.layer.empty())
    picture.notes.push_back("the layer '" + channels.layer + "' was read");
  if (file.parts() > 1)
    picture.notes.push_back("part " + std::to_string(channels.part) + " of " +
                            std::to_string(file.parts()) + " was read");
  if (header.dataWindow() != header.displayWindow())
    picture.notes.emplace_back("the data window was placed in the display window");
  return picture;
}

/// A message of the library without its beginning, which names the stream.
std::string message_of(const std::exception& error) {
  const std::string text = error.what();
  const std::string prefix = '"' + std::string(stream_name) + "\". ";
  const auto found = text.find(prefix);
  return found == std::string::npos ? text : text.substr(found + prefix.size());
}

} // namespace

DecodedImage read_exr(const Task& task) {
  try {
    return read_file(task);
  } catch (const Iex::BaseExc& error) {
    throw Refusal("cannot be decoded: OpenEXR: " + first_line(message_of(error)));
  }
}

} // namespace haarlight::probe::reader
