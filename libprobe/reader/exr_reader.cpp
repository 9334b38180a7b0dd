// OpenEXR files: the colours of one layer, placed in the display window.

#include "decoder.h"
#include "file/colour_space.h"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTileDescriptionAttribute.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <functional>
#include <optional>
#include <thread>

namespace haarlight::probe::reader {
namespace {

// The choice of the channels that are the colours.

/// The channels of one layer of one part, by their role. Names are complete, empty if missing.
struct ExrChannels {
  int part = 0;
  std::string layer; ///< the part of the names before the last dot; empty if there is none
  std::string red, green, blue;
  std::string luminance, red_chroma, blue_chroma; ///< Y, RY, BY
};

constexpr const char* advice = "choose one by layer or part";

/// Longest list of layers in a message.
constexpr std::size_t longest_list = 600;

std::string lower_case(std::string text) {
  for (char& c : text)
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

struct Layer {
  ExrChannels channels;
  std::string part_name;
  bool deep = false;
  bool has_x = false;             ///< then Y is a coordinate, not a luminance
  std::vector<std::string> names; ///< of its channels, without the layer

  bool has_colours() const {
    return !deep && !channels.red.empty() && !channels.green.empty() && !channels.blue.empty();
  }
  bool has_luminance() const { return !deep && !channels.luminance.empty() && !has_x; }
};

/// The role of a channel; nullptr if it has none.
std::string* role(ExrChannels& channels, const std::string& name) {
  const std::string lower = lower_case(name);
  if (lower == "r" || lower == "red")
    return &channels.red;
  if (lower == "g" || lower == "green")
    return &channels.green;
  if (lower == "b" || lower == "blue")
    return &channels.blue;
  if (lower == "y")
    return &channels.luminance;
  if (lower == "ry")
    return &channels.red_chroma;
  if (lower == "by")
    return &channels.blue_chroma;
  return nullptr;
}

void add_channel(Layer& layer, const std::string& full_name, const std::string& name) {
  layer.names.push_back(name);
  layer.has_x = layer.has_x || lower_case(name) == "x";
  std::string* place = role(layer.channels, name);
  if (place == nullptr)
    return;
  if (!place->empty() && lower_case(*place) == lower_case(full_name))
    throw DecodeError("has the channels " + *place + " and " + full_name +
                      ", which differ in letter case only");
  if (place->empty() || name.size() < 3) // R rather than Red
    *place = full_name;
}

std::vector<Layer> layers_of_part(const Imf::Header& header, int part) {
  std::vector<Layer> layers;
  for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
    const std::string full_name = i.name();
    const auto dot = full_name.rfind('.');
    const std::string layer = dot == std::string::npos ? "" : full_name.substr(0, dot);
    auto found = std::find_if(layers.begin(), layers.end(),
                              [&](const Layer& l) { return l.channels.layer == layer; });
    if (found == layers.end()) {
      Layer added;
      added.channels.part = part;
      added.channels.layer = layer;
      added.part_name = header.hasName() ? header.name() : "";
      added.deep = header.hasType() && Imf::isDeepData(header.type());
      layers.push_back(added);
      found = layers.end() - 1;
    }
    add_channel(*found, full_name,
                dot == std::string::npos ? full_name : full_name.substr(dot + 1));
  }
  return layers;
}

std::string list(const std::vector<Layer>& layers, bool name_parts) {
  std::string text;
  for (const Layer& layer : layers) {
    if (text.size() > longest_list)
      return text + "; …";
    text += text.empty() ? "" : "; ";
    if (name_parts) {
      text += "part " + std::to_string(layer.channels.part);
      if (!layer.part_name.empty())
        text += " '" + layer.part_name + "'";
      text += layer.deep ? " (deep) " : " ";
    }
    if (!layer.channels.layer.empty())
      text += "layer '" + layer.channels.layer + "' ";
    text += "channels";
    for (std::size_t i = 0; i < layer.names.size(); ++i)
      text += (i > 0 ? ", " : " ") + layer.names[i].substr(0, 64);
  }
  return text;
}

/// The part a user names by its name or else by its number.
int chosen_part(const Imf::MultiPartInputFile& file, const std::string& choice) {
  for (int part = 0; part < file.parts(); ++part)
    if (file.header(part).hasName() && file.header(part).name() == choice)
      return part;
  int number = -1;
  const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
  if (error == std::errc{} && end == choice.data() + choice.size() && number >= 0 &&
      number < file.parts())
    return number;
  std::string names;
  for (int part = 0; part < file.parts() && names.size() < longest_list; ++part)
    names += (part > 0 ? ", " : "") + std::to_string(part) +
             (file.header(part).hasName() ? " '" + file.header(part).name() + "'" : "");
  throw DecodeError("has no part '" + choice + "', its parts are " + names);
}

/// Keeps the layers of a name: in the same letter case, else in any. A part's name counts for its
/// channels without a layer.
void keep_layer(std::vector<Layer>& layers, const std::string& choice) {
  const auto is_named = [&](const Layer& layer, bool any_case) {
    const std::string& name = layer.channels.layer.empty() ? layer.part_name : layer.channels.layer;
    return any_case ? lower_case(name) == lower_case(choice) : name == choice;
  };
  for (const bool any_case : {false, true}) {
    std::vector<Layer> kept;
    for (const Layer& layer : layers)
      if (is_named(layer, any_case))
        kept.push_back(layer);
    if (!kept.empty()) {
      layers = std::move(kept);
      return;
    }
  }
  layers.clear();
}

using Condition = std::function<bool(const Layer&)>;

/// The conditions a layer may meet, the most preferred first.
std::vector<Condition> preferences(bool layer_chosen) {
  const Condition colours = [](const Layer& l) { return l.has_colours(); };
  const Condition luminance = [](const Layer& l) { return l.has_luminance(); };
  if (layer_chosen)
    return {colours, luminance};
  const auto without_layer = [](const Condition& condition) {
    return [condition](const Layer& l) { return l.channels.layer.empty() && condition(l); };
  };
  return {without_layer(colours), colours, without_layer(luminance), luminance};
}

/// Looks over all parts for R, G, B without a layer; then for one layer with these; then for Y
/// without a layer; then for one layer with Y. Letter case does not matter; Red, Green and Blue
/// count too. Deep parts are left out.
/// @throws DecodeError that lists parts and layers if there is none, or more than one
ExrChannels find_colours(const Imf::MultiPartInputFile& file, const ImageChoice& choice) {
  const int only_part = choice.part.empty() ? -1 : chosen_part(file, choice.part);
  std::vector<Layer> layers;
  for (int part = 0; part < file.parts(); ++part)
    if (only_part < 0 || part == only_part)
      for (Layer& layer : layers_of_part(file.header(part), part))
        layers.push_back(std::move(layer));
  const std::string all = list(layers, file.parts() > 1);
  if (!choice.layer.empty())
    keep_layer(layers, choice.layer);
  if (layers.empty())
    throw DecodeError("has no layer '" + choice.layer + "', it has " + all);
  for (const Condition& condition : preferences(!choice.layer.empty())) {
    std::vector<Layer> met;
    std::copy_if(layers.begin(), layers.end(), std::back_inserter(met), condition);
    if (met.size() > 1)
      throw DecodeError("has several colour images, " + std::string(advice) + ": " +
                        list(met, file.parts() > 1));
    if (met.size() == 1)
      return met.front().channels;
  }
  const bool deep =
      std::any_of(layers.begin(), layers.end(), [](const Layer& l) { return l.deep; });
  throw DecodeError(std::string("has no layer of the channels R, G, B or Y") +
                    (deep ? ", and deep parts are not read" : "") + ": it has " + all);
}

// Reading them.

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
      throw DecodeError("is cut short: it ends at byte " + std::to_string(m_bytes.size()));
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

/// Largest number of raw bytes per byte of the file: 64 is a run of 127 equal bytes in two, 1032
/// the limit of deflate, PXR24 drops a byte of four before it, B44A packs 16 halves into 3 bytes.
/// PIZ codes 256 equal values in 10 bits. DWA deflates one value per 8x8 block.
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
    throw DecodeError("has a display window of " + std::to_string(width_of(display)) + " x " +
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
      throw DecodeError("has the subsampled channel " + names[c] +
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
    throw DecodeError(
        "has luminance and chroma channels, which are read from files of one part only, "
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
    throw DecodeError("has a data window outside the display window, so nothing of it is shown");
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
    throw DecodeError("has chromaticities that span no colour space");
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
    throw DecodeError("cannot be decoded: OpenEXR: " + first_line(message_of(error)));
  }
}

} // namespace haarlight::probe::reader
