#include <image/map_set_exr.h>

#include <image/exr_check.h>
#include <image/exr_io.h>

#include <wavelet/base/error.h>
#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledInputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <span>
#include <vector>

namespace haarlight::image {

/// The maps described by an EXR's header.
struct ExrMapLayout {
  Imf::Header header;
  wavelet::SetInfo info;
  bool plain = false; ///< one map as an ordinary picture; else one tile per map
  RgbChannels channels;
};

namespace {

using wavelet::Fold;
using wavelet::Map;
using wavelet::MapSource;
using wavelet::SetInfo;
using wavelet::SetKind;

// Header attributes.

/// The sphere map of every set, as stated by the attribute haarlight:domain.
constexpr const char* domain_name = "octahedral equal-area (Clarberg 2008)";

constexpr std::array<const char*, 4> kind_names = {"generic", "brdf", "light", "transfer"};
constexpr std::array<const char*, 3> fold_names = {"none", "rotations", "mirrors"};
constexpr int largest_size = 1 << 13; // as .haar files have it
constexpr int most_columns = 1 << 16;

void put(Imf::Header& header, const std::string& name, const std::string& text) {
  header.insert("haarlight:" + name, Imf::StringAttribute(text));
}

void put(Imf::Header& header, const std::string& name, int number) {
  header.insert("haarlight:" + name, Imf::IntAttribute(number));
}

/// Attributes of one file, for which errors name it.
class Attributes {
public:
  Attributes(const Imf::Header& header, const std::string& path) : m_header(header), m_path(path) {}

  const std::string& text(const std::string& name) const {
    return find<Imf::StringAttribute>(name).value();
  }
  int number(const std::string& name, int low, int high) const {
    const int value = find<Imf::IntAttribute>(name).value();
    if (value < low || value > high)
      fail("haarlight:" + name + " is " + std::to_string(value) + ", from " + std::to_string(low) +
           " to " + std::to_string(high) + " is needed");
    return value;
  }
  template <class E>
  E choice(const std::string& name, std::span<const char* const> words) const {
    const std::string& word = text(name);
    for (std::uint32_t i = 0; i < words.size(); ++i)
      if (word == words[i])
        return static_cast<E>(i);
    std::string choices = words.front();
    for (std::size_t i = 1; i < words.size(); ++i)
      choices.append(i + 1 < words.size() ? ", " : " or ").append(words[i]);
    fail("haarlight:" + name + " is '" + word + "', " + choices + " is needed");
  }
  [[noreturn]] void fail(const std::string& message) const { throw_input_error(m_path, message); }

private:
  template <class T>
  const T& find(const std::string& name) const {
    const T* attribute = m_header.findTypedAttribute<T>("haarlight:" + name);
    if (attribute == nullptr)
      fail("lacks the header attribute haarlight:" + name + ", which map sets have");
    return *attribute;
  }

  const Imf::Header& m_header;
  const std::string& m_path;
};

void check_grid(const Attributes& attributes, const SetInfo& info) {
  if (!std::has_single_bit(static_cast<unsigned>(info.size)))
    attributes.fail("haarlight:size is " + std::to_string(info.size) +
                    ", a power of two is needed");
  if (attributes.text("domain") != domain_name)
    attributes.fail("haarlight:domain is '" + attributes.text("domain") + "', '" + domain_name +
                    "' is needed");
}

/// Number of rolls that the stored rows represent.
int rolls_of(const SetInfo& info) {
  if (info.kind != SetKind::Brdf)
    return 1;
  const int copies[3] = {1, 4, 8};
  return info.rows * copies[static_cast<std::size_t>(info.fold)];
}

void check_words(const Attributes& attributes, const SetInfo& info) {
  if (info.rolls != rolls_of(info) || (info.kind != SetKind::Brdf && info.fold != Fold::None))
    attributes.fail("haarlight:rolls does not fit kind, rows and fold");
  if (info.frame.find('\n') != std::string::npos || info.units.find('\n') != std::string::npos)
    attributes.fail("haarlight:frame or haarlight:units has a line break");
}

/// True if the header is one of a map set of this toolkit.
bool has_set_attributes(const Imf::Header& header) {
  return header.findTypedAttribute<Imf::StringAttribute>("haarlight:kind") != nullptr;
}

/// SetInfo as header attributes haarlight:*.
void set_attributes(Imf::Header& header, const SetInfo& info) {
  put(header, "kind", kind_names[static_cast<std::size_t>(info.kind)]);
  put(header, "domain", domain_name);
  put(header, "size", info.size);
  put(header, "columns", info.columns);
  put(header, "rows", info.rows);
  put(header, "rolls", info.rolls);
  put(header, "fold", fold_names[static_cast<std::size_t>(info.fold)]);
  put(header, "cosine", info.cosine ? 1 : 0);
  put(header, "world_frame", info.world_frame ? 1 : 0);
  put(header, "frame", info.frame);
  put(header, "units", info.units);
  put(header, "provenance", info.provenance.text());
}

/// @throws Error(Input) for missing or unknown attributes and for ones that contradict each other
SetInfo read_attributes(const Imf::Header& header, const std::string& path) {
  const Attributes attributes(header, path);
  SetInfo info;
  info.kind = attributes.choice<SetKind>("kind", kind_names);
  info.size = attributes.number("size", 1, largest_size);
  info.columns = attributes.number("columns", 1, most_columns);
  info.rows = attributes.number("rows", 1, most_columns);
  info.rolls = attributes.number("rolls", 1, 8 * most_columns);
  info.fold = attributes.choice<Fold>("fold", fold_names);
  info.cosine = attributes.number("cosine", 0, 1) == 1;
  info.world_frame = attributes.number("world_frame", 0, 1) == 1;
  info.frame = attributes.text("frame");
  info.units = attributes.text("units");
  info.provenance = Provenance::parse(attributes.text("provenance"));
  check_grid(attributes, info);
  check_words(attributes, info);
  return info;
}

// Reading.

struct Extent {
  Imath::V2i origin;
  std::int64_t width = 0;
  std::int64_t height = 0;
};

Extent extent_of(const Imf::Header& header) {
  const Imath::Box2i& window = header.dataWindow();
  return {window.min, std::int64_t{window.max.x} - window.min.x + 1,
          std::int64_t{window.max.y} - window.min.y + 1};
}

std::string size_text(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

void check_tiles(const Imf::Header& header, const SetInfo& info, const std::string& path) {
  const Extent extent = extent_of(header);
  const std::int64_t width = std::int64_t{info.columns} * info.size;
  const std::int64_t height = std::int64_t{info.rows} * info.size;
  if (extent.width != width || extent.height != height || extent.origin != Imath::V2i(0, 0))
    throw_input_error(path, "is of " + size_text(extent.width, extent.height) +
                                ", its header asks for " + size_text(width, height));
  const Imf::TileDescription& tiles = header.tileDescription();
  const auto side = static_cast<unsigned>(info.size);
  if (tiles.mode != Imf::ONE_LEVEL || tiles.xSize != side || tiles.ySize != side)
    throw_input_error(path, "has tiles of " + size_text(tiles.xSize, tiles.ySize) +
                                ", one tile per map of " + size_text(side, side) + " is needed");
}

SetInfo plain_info(const Imf::Header& header, const InputFile& file) {
  const Imath::V2i size = display_size(header, file.path());
  if (size.x != size.y || size.x > (1 << 13) || !std::has_single_bit(static_cast<unsigned>(size.x)))
    throw_input_error(file.path(),
                      "is no map set (the header attribute haarlight:kind is missing), and of " +
                          size_text(size.x, size.y) +
                          " no single map either: a square of a power of two is needed");
  SetInfo info;
  info.size = size.x;
  info.frame = "as in the source image";
  info.units = "as in the source image";
  info.provenance.set("source", base_name(file.path()));
  info.provenance.set("source_hash", hash_text(file.bytes()));
  info.provenance.set("version", version_text());
  return info;
}

/// @throws Error(Input) for a header that is neither one of a map set nor of a square picture of a
///         power of two of pixels a side
ExrMapLayout read_map_layout(const InputFile& file) {
  ExrMapLayout layout;
  layout.header = read_exr_header(file);
  const Imf::Header& header = layout.header;
  layout.channels = choose_channels(header, file.path());
  layout.plain = !has_set_attributes(header);
  layout.info = layout.plain ? plain_info(header, file) : read_attributes(header, file.path());
  if (layout.plain)
    return layout;
  if (!header.hasTileDescription())
    throw_input_error(file.path(), "is a map set without tiles; one tile per map is needed");
  check_tiles(header, layout.info, file.path());
  return layout;
}

/// The frame buffer of a map whose upper left corner is at `origin` of the image. A grey image
/// fills the first channel only.
Imf::FrameBuffer frame_of_map(Map& map, const Imath::V2i& origin, const RgbChannels& channels) {
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < (channels.grey() ? 1U : 3U); ++c)
    frame.insert(channels.names[c],
                 Imf::Slice::Make(Imf::FLOAT, map.rgb.data() + c, origin, map.size, map.size,
                                  3 * sizeof(float),
                                  3 * sizeof(float) * static_cast<std::size_t>(map.size)));
  return frame;
}

void check_finite(const Map& map, int column, int row, const std::string& path) {
  const auto place = std::find_if(map.rgb.begin(), map.rgb.end(),
                                  [](float value) { return !std::isfinite(value); });
  if (place == map.rgb.end())
    return;
  const auto pixel = static_cast<int>((place - map.rgb.begin()) / 3);
  throw_input_error(path, "map " + std::to_string(column) + "," + std::to_string(row) + ": pixel " +
                              std::to_string(pixel % map.size) + "," +
                              std::to_string(pixel / map.size) + " is not finite");
}

} // namespace

class ExrMapSource::Reader {
public:
  explicit Reader(const std::string& path) : m_file(path), m_layout(read_map_layout(m_file)) {}

  const SetInfo& info() const { return m_layout.info; }

  Map make(int column, int row) const {
    Map map(m_layout.info.size);
    if (m_layout.plain)
      map.rgb = read_rgb(m_file, m_layout.header).rgb;
    else
      with_input_errors(m_file.path(), [&] { read_tile(column, row, map); });
    if (!m_layout.plain && m_layout.channels.grey())
      spread_grey(map.rgb);
    check_finite(map, column, row, m_file.path());
    return map;
  }

private:
  /// One open view of the file. OpenEXR's files have one current frame buffer, so a thread needs
  /// its own.
  struct TileView {
    ExrInputStream stream;
    Imf::TiledInputFile image;
    explicit TileView(const InputFile& file) : stream(file), image(stream, 0) {}
  };

  void read_tile(int column, int row, Map& map) const {
    std::unique_ptr<TileView> view = take_view();
    const Imath::V2i origin(column * m_layout.info.size, row * m_layout.info.size);
    view->image.setFrameBuffer(frame_of_map(map, origin, m_layout.channels));
    view->image.readTile(column, row);
    const std::lock_guard lock(m_mutex);
    m_views.push_back(std::move(view));
  }

  std::unique_ptr<TileView> take_view() const {
    {
      const std::lock_guard lock(m_mutex);
      if (!m_views.empty()) {
        std::unique_ptr<TileView> view = std::move(m_views.back());
        m_views.pop_back();
        return view;
      }
    }
    return std::make_unique<TileView>(m_file);
  }

  InputFile m_file;
  ExrMapLayout m_layout;
  mutable std::mutex m_mutex;
  mutable std::vector<std::unique_ptr<TileView>> m_views; ///< open and unused
};

ExrMapSource::ExrMapSource(const std::string& path) : m_reader(std::make_unique<Reader>(path)) {}
ExrMapSource::~ExrMapSource() = default;

const SetInfo& ExrMapSource::info() const { return m_reader->info(); }

Map ExrMapSource::make(int column, int row) const { return m_reader->make(column, row); }

// Writing.

namespace {

constexpr std::size_t batch_bytes = std::size_t{64} << 20; ///< of maps held at once, if one fits

Imf::Header set_header(const SetInfo& info) {
  Imf::Header header(info.columns * info.size, info.rows * info.size);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.lineOrder() = Imf::INCREASING_Y;
  for (const char* channel : {"R", "G", "B"})
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
  const auto side = static_cast<unsigned>(info.size);
  header.setTileDescription(Imf::TileDescription(side, side, Imf::ONE_LEVEL));
  set_attributes(header, info);
  return header;
}

/// Maps side by side that are made and written together.
class Batch {
public:
  Batch(const SetInfo& info, int most)
      : m_size(info.size), m_width(most * info.size),
        m_pixels(3 * static_cast<std::size_t>(m_width) * static_cast<std::size_t>(m_size)) {}

  void place(int index, const Map& map) {
    const std::size_t row = 3 * static_cast<std::size_t>(m_size);
    for (int y = 0; y < m_size; ++y)
      std::memcpy(m_pixels.data() + (static_cast<std::size_t>(y) * m_width + index * m_size) * 3,
                  map.rgb.data() + static_cast<std::size_t>(y) * row, row * sizeof(float));
  }

  /// The batch seen at the tiles (column …, row).
  Imf::FrameBuffer frame(int column, int row) const {
    Imf::FrameBuffer frame;
    const Imath::V2i origin(column * m_size, row * m_size);
    const char* const names[3] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
      frame.insert(names[c],
                   Imf::Slice::Make(Imf::FLOAT, m_pixels.data() + c, origin, m_width, m_size,
                                    3 * sizeof(float),
                                    3 * sizeof(float) * static_cast<std::size_t>(m_width)));
    return frame;
  }

private:
  int m_size;
  int m_width;
  std::vector<float> m_pixels;
};

int batch_size(const SetInfo& info) {
  const auto bytes = 12 * static_cast<std::size_t>(info.size) * static_cast<std::size_t>(info.size);
  const auto fitting = static_cast<int>(std::max<std::size_t>(batch_bytes / bytes, 1));
  return std::min({info.columns, fitting, 8 * thread_count()});
}

void make_batch(const MapSource& source, int column, int row, int count, Batch& batch,
                wavelet::ConservationMeter& meter) {
  parallel_for(static_cast<std::size_t>(count), [&](std::size_t index) {
    const int i = static_cast<int>(index);
    const Map map = source.make(column + i, row);
    meter.add(column + i, row, map, source.integral(column + i, row));
    batch.place(i, map);
  });
}

void write_tiles(const MapSource& source, Imf::TiledOutputFile& image,
                 const ExrOutputStream& stream, wavelet::ConservationMeter& meter,
                 const wavelet::Progress& progress) {
  const SetInfo& info = source.info();
  const int most = batch_size(info);
  const std::string purpose = std::to_string(most) + " maps of " + std::to_string(info.size) +
                              " x " + std::to_string(info.size) + " pixels";
  const std::uint64_t bytes = 12 * static_cast<std::uint64_t>(most) *
                              static_cast<std::uint64_t>(info.size) *
                              static_cast<std::uint64_t>(info.size);
  Batch batch = with_memory_for(purpose, bytes, [&] { return Batch(info, most); });
  for (int row = 0; row < info.rows; ++row)
    for (int column = 0; column < info.columns; column += most) {
      const int count = std::min(most, info.columns - column);
      with_memory_for(purpose, bytes,
                      [&] { make_batch(source, column, row, count, batch, meter); });
      image.setFrameBuffer(batch.frame(column, row));
      image.writeTiles(column, column + count - 1, row, row);
      stream.rethrow();
      if (progress)
        progress(row * info.columns + column + count, info.map_count());
    }
}

} // namespace

MapSetResult write_map_set_exr(const MapSource& source, OutputFile& file,
                               const wavelet::Progress& progress) {
  const SetInfo& info = source.info();
  if (std::max(info.columns, info.rows) > (1 << 29) / info.size)
    throw_output_error(file.path(), "would be wider than an EXR can be; write a .haar instead");
  wavelet::ConservationMeter meter(info);
  const int threads = start_exr_threads();
  ExrOutputStream stream(file);
  {
    Imf::TiledOutputFile image(stream, set_header(info), threads);
    write_tiles(source, image, stream, meter, progress);
  }
  stream.rethrow();
  return {meter.result(), stream.size()};
}

} // namespace haarlight::image
