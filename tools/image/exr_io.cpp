#include <image/exr_io.h>

#include <image/exr_check.h>
#include <image/image_exr.h>

#include <wavelet/base/parallel.h>

#include <Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>
#include <vector>

namespace haarlight::image {

ExrOutputStream::ExrOutputStream(OutputFile& file)
    : Imf::OStream(file.path().c_str()), m_file(file) {}

void ExrOutputStream::write(const char bytes[], int count) {
  if (m_error)
    return;
  try {
    m_file.write(bytes, static_cast<std::size_t>(count));
    m_size = std::max(m_size, m_file.position());
  } catch (const Error& error) {
    m_error = error;
  }
}

void ExrOutputStream::rethrow() const {
  if (m_error)
    throw Error(*m_error);
}

int start_exr_threads() {
  try {
    Imf::setGlobalThreadCount(thread_count());
    return thread_count();
  } catch (const std::system_error&) {
    Imf::setGlobalThreadCount(0);
    return 0;
  }
}

ExrInputStream::ExrInputStream(const InputFile& file)
    : Imf::IStream(file.path().c_str()), m_bytes(file.bytes()) {}

bool ExrInputStream::read(char bytes[], int count) {
  const auto wanted = static_cast<std::uint64_t>(count);
  if (count < 0 || m_position > m_bytes.size() || wanted > m_bytes.size() - m_position)
    throw Iex::InputExc("the file ends too early");
  std::memcpy(bytes, m_bytes.data() + m_position, wanted);
  m_position += wanted;
  return m_position < m_bytes.size();
}

namespace {

/// Pixels of a display window beyond those of the data window: a cropped 4K frame fits.
constexpr std::int64_t most_empty_pixels = std::int64_t{1} << 24;

bool has_all(const Imf::ChannelList& channels, const std::array<std::string, 3>& names) {
  return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return channels.findChannel(name) != nullptr;
  });
}

/// Triples L.R, L.G, L.B.
std::vector<std::array<std::string, 3>> layers_of(const Imf::ChannelList& channels) {
  std::vector<std::array<std::string, 3>> layers;
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    const std::string name = c.name();
    if (!name.ends_with(".R"))
      continue;
    const std::string layer = name.substr(0, name.size() - 1);
    const std::array<std::string, 3> names = {name, layer + "G", layer + "B"};
    if (has_all(channels, names))
      layers.push_back(names);
  }
  return layers;
}

/// The first names of the channels, for messages.
std::string list_of(const Imf::ChannelList& channels) {
  constexpr int most = 16;
  std::string list;
  int count = 0;
  for (auto c = channels.begin(); c != channels.end(); ++c, ++count)
    if (count < most)
      list += (count > 0 ? ", " : "") + printable(std::string(c.name()).substr(0, 40));
  return count > most ? list + " and " + std::to_string(count - most) + " more" : list;
}

void check_channel(const Imf::Channel& channel, const std::string& name, const std::string& path) {
  if (channel.xSampling != 1 || channel.ySampling != 1)
    throw_input_error(path, "channel " + name + " is subsampled, whole channels are needed");
  if (channel.type == Imf::UINT)
    throw_input_error(path, "channel " + name + " holds integers, floats are needed");
}

void check_chromaticities(const Imf::Header& header, const std::string& path) {
  if (!Imf::hasChromaticities(header))
    return;
  const Imf::Chromaticities found = Imf::chromaticities(header);
  const Imf::Chromaticities rec709;
  const auto near = [](const Imath::V2f& a, const Imath::V2f& b) {
    return std::abs(a.x - b.x) < 0.002F && std::abs(a.y - b.y) < 0.002F; // headers round
  };
  if (!near(found.red, rec709.red) || !near(found.green, rec709.green) ||
      !near(found.blue, rec709.blue) || !near(found.white, rec709.white))
    throw_input_error(path, "has other chromaticities than those of Rec. 709; convert it first");
}

std::pair<std::int64_t, std::int64_t> size_of(const Imath::Box2i& window) {
  return {std::int64_t{window.max.x} - window.min.x + 1,
          std::int64_t{window.max.y} - window.min.y + 1};
}

Image read_data_window(const InputFile& file, const Imath::Box2i& window,
                       const RgbChannels& channels) {
  const auto [width, height] = size_of(window);
  Image picture(static_cast<int>(width), static_cast<int>(height));
  Imf::FrameBuffer frame;
  const std::size_t step = 3 * sizeof(float);
  for (std::size_t c = 0; c < (channels.grey() ? 1U : 3U); ++c)
    frame.insert(channels.names[c],
                 Imf::Slice::Make(Imf::FLOAT, picture.rgb.data() + c, window.min, width, height,
                                  step, step * static_cast<std::size_t>(width)));
  with_input_errors(file.path(), [&] {
    ExrInputStream stream(file);
    Imf::InputFile input(stream, 0);
    input.setFrameBuffer(frame);
    input.readPixels(window.min.y, window.max.y);
  });
  if (channels.grey())
    spread_grey(picture.rgb);
  return picture;
}

/// The part of a picture of the window `from` that lies in the window `to`, black around it.
Image moved(const Image& picture, const Imath::Box2i& from, const Imath::Box2i& to) {
  const auto [width, height] = size_of(to);
  Image result(static_cast<int>(width), static_cast<int>(height));
  const int x0 = std::max(from.min.x, to.min.x);
  const int x1 = std::min(from.max.x, to.max.x);
  for (int y = std::max(from.min.y, to.min.y); y <= std::min(from.max.y, to.max.y); ++y)
    std::copy_n(picture.rgb.data() + picture.offset(x0 - from.min.x, y - from.min.y),
                3 * static_cast<std::size_t>(x1 - x0 + 1),
                result.rgb.data() + result.offset(x0 - to.min.x, y - to.min.y));
  return result;
}

} // namespace

RgbChannels choose_channels(const Imf::Header& header, const std::string& path) {
  const Imf::ChannelList& channels = header.channels();
  const auto layers = layers_of(channels);
  RgbChannels chosen{{"R", "G", "B"}};
  if (!has_all(channels, chosen.names)) {
    if (layers.size() == 1)
      chosen.names = layers[0];
    else if (layers.empty() && channels.findChannel("Y") != nullptr)
      chosen.names.fill("Y");
    else
      throw_input_error(path, (layers.empty() ? "has no channels R, G, B or Y"
                                              : "has several layers and no channels R, G, B") +
                                  (": it has " + list_of(channels)));
  }
  if (chosen.grey() &&
      (channels.findChannel("RY") != nullptr || channels.findChannel("BY") != nullptr))
    throw_input_error(path, "holds luminance and chroma (Y, RY, BY); R, G, B or Y is needed");
  for (const std::string& name : chosen.names)
    check_channel(channels[name], printable(name), path);
  if (!chosen.grey())
    check_chromaticities(header, path);
  return chosen;
}

Imath::V2i display_size(const Imf::Header& header, const std::string& path) {
  const Imath::Box2i& display = header.displayWindow();
  const auto [width, height] = size_of(display);
  const auto [data_width, data_height] = size_of(header.dataWindow());
  const std::int64_t most = std::min(most_exr_pixels, data_width * data_height + most_empty_pixels);
  if (width < 1 || height < 1 || width > most / height)
    throw_input_error(path, "has a display window of " + std::to_string(width) + " x " +
                                std::to_string(height) + " pixels, at most " +
                                std::to_string(most) + " are read of this file");
  if (!display.intersects(header.dataWindow()))
    throw_input_error(path, "has no pixels in its display window");
  return {static_cast<int>(width), static_cast<int>(height)};
}

Image read_rgb(const InputFile& file, const Imf::Header& header) {
  display_size(header, file.path());
  const RgbChannels channels = choose_channels(header, file.path());
  Image picture = read_data_window(file, header.dataWindow(), channels);
  if (header.dataWindow() == header.displayWindow())
    return picture;
  return moved(picture, header.dataWindow(), header.displayWindow());
}

void spread_grey(std::vector<float>& rgb) {
  for (std::size_t i = 0; i < rgb.size(); i += 3)
    rgb[i + 2] = rgb[i + 1] = rgb[i];
}

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

/// A check for OutputFile::commit: the file opens and is complete. @throws Error(Output)
void check_exr_complete(const std::string& temporary_path) {
  try {
    Imf::InputFile file(temporary_path.c_str());
    if (file.isComplete())
      return;
  } catch (const std::exception&) { // NOLINT(bugprone-empty-catch): reported below
  }
  throw_output_error(temporary_path, "is incomplete after writing");
}

} // namespace

void commit_exr(OutputFile& file) { file.commit(check_exr_complete); }

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

void write_exr(const std::string& path, const Image& picture) {
  const float* first = picture.rgb.data();
  ExrImage image;
  image.width = picture.width;
  image.height = picture.height;
  image.channels = {{"R", first, 3}, {"G", first + 1, 3}, {"B", first + 2, 3}};
  write_exr(path, image);
}

Image read_exr(const std::string& path) {
  const InputFile file(path);
  return read_rgb(file, read_exr_header(file));
}

} // namespace haarlight::image
