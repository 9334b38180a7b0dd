#include <image/map_set_exr.h>

#include <image/exr_stream.h>
#include <image/map_set_attributes.h>

#include <wavelet/error.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfTiledInputFile.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>

namespace haarlight::image {
namespace {

using wavelet::Map;
using wavelet::SetInfo;

/// One open view of the file. OpenEXR's files have one current frame buffer, so a thread needs its
/// own.
template <class File>
struct View {
  ExrInputStream stream;
  File image;
  explicit View(const InputFile& file) : stream(file), image(stream, 0) {}
};

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

/// R, G and B, or Y for all three.
std::vector<std::string> channel_names(const Imf::Header& header, const std::string& path) {
  const Imf::ChannelList& channels = header.channels();
  std::vector<std::string> names = {"R", "G", "B"};
  if (channels.findChannel("R") == nullptr && channels.findChannel("Y") != nullptr)
    names.assign(3, "Y");
  for (const std::string& name : names) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (channel == nullptr)
      throw_input_error(path, "has no channel " + name + "; R, G, B or Y are needed");
    if (channel->xSampling != 1 || channel->ySampling != 1 || channel->type == Imf::UINT)
      throw_input_error(path, "channel " + name + " is subsampled or of integers");
  }
  return names;
}

/// Where pixels of a map go whose upper left corner is at `origin` of the image. A grey image fills
/// the first channel only.
Imf::FrameBuffer frame_of(Map& map, const Imath::V2i& origin,
                          const std::vector<std::string>& names) {
  Imf::FrameBuffer frame;
  const bool grey = names[0] == names[1];
  for (std::size_t c = 0; c < (grey ? 1U : 3U); ++c)
    frame.insert(names[c],
                 Imf::Slice::Make(Imf::FLOAT, map.rgb.data() + c, origin, map.size, map.size,
                                  3 * sizeof(float),
                                  3 * sizeof(float) * static_cast<std::size_t>(map.size)));
  return frame;
}

void spread_grey(Map& map) {
  for (std::size_t i = 0; i < map.rgb.size(); i += 3)
    map.rgb[i + 2] = map.rgb[i + 1] = map.rgb[i];
}

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
  const Extent extent = extent_of(header);
  if (extent.width != extent.height || extent.width < 1 || extent.width > (1 << 13) ||
      !std::has_single_bit(static_cast<std::uint64_t>(extent.width)))
    throw_input_error(file.path(),
                      "is no map set (the header attribute haarlight:kind is missing), and of " +
                          size_text(extent.width, extent.height) +
                          " no single map either: a square of a power of two is needed");
  SetInfo info;
  info.size = static_cast<int>(extent.width);
  info.frame = "as in the source image";
  info.units = "as in the source image";
  info.provenance.set("source", base_name(file.path()));
  info.provenance.set("source_hash", hash_text(file.bytes()));
  info.provenance.set("version", version_text());
  return info;
}

} // namespace

class ExrMapSource::Reader {
public:
  explicit Reader(const std::string& path) : m_file(path) {
    const Imf::Header header = read_exr_header(m_file);
    m_names = channel_names(header, path);
    m_plain = !has_set_attributes(header);
    m_info = m_plain ? plain_info(header, m_file) : read_attributes(header, path);
    m_origin = header.dataWindow().min;
    if (m_plain) {
      require_complete<Imf::InputFile>();
      return;
    }
    if (!header.hasTileDescription())
      throw_input_error(path, "is a map set without tiles; one tile per map is needed");
    check_tiles(header, m_info, path);
    require_complete<Imf::TiledInputFile>();
  }

  const SetInfo& info() const { return m_info; }

  Map make(int column, int row) const {
    Map map(m_info.size);
    with_input_errors(m_file.path(), [&] {
      if (m_plain)
        read_plain(map);
      else
        read_tile(column, row, map);
    });
    if (m_names[0] == m_names[1])
      spread_grey(map);
    check_finite(map, column, row, m_file.path());
    return map;
  }

private:
  using TileView = View<Imf::TiledInputFile>;

  template <class File>
  void require_complete() const {
    const bool complete =
        with_input_errors(m_file.path(), [&] { return View<File>(m_file).image.isComplete(); });
    if (!complete)
      throw_input_error(m_file.path(), "is truncated: pixels are missing");
  }

  void read_plain(Map& map) const {
    View<Imf::InputFile> view(m_file);
    view.image.setFrameBuffer(frame_of(map, m_origin, m_names));
    view.image.readPixels(m_origin.y, m_origin.y + m_info.size - 1);
  }

  void read_tile(int column, int row, Map& map) const {
    std::unique_ptr<TileView> view = take_view();
    const Imath::V2i origin(column * m_info.size, row * m_info.size);
    view->image.setFrameBuffer(frame_of(map, origin, m_names));
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
  SetInfo m_info;
  Imath::V2i m_origin;
  std::vector<std::string> m_names;
  bool m_plain = false;
  mutable std::mutex m_mutex;
  mutable std::vector<std::unique_ptr<TileView>> m_views; ///< open and unused
};

ExrMapSource::ExrMapSource(const std::string& path) : m_reader(std::make_unique<Reader>(path)) {}
ExrMapSource::~ExrMapSource() = default;

const SetInfo& ExrMapSource::info() const { return m_reader->info(); }

Map ExrMapSource::make(int column, int row) const { return m_reader->make(column, row); }

} // namespace haarlight::image
