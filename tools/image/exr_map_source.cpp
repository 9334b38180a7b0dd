#include <image/map_set_exr.h>

#include <image/exr_map_layout.h>
#include <image/exr_stream.h>

#include <wavelet/base/error.h>

#include <OpenEXR/ImfTiledInputFile.h>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace haarlight::image {
namespace {

using wavelet::Map;
using wavelet::SetInfo;

/// One open view of the file. OpenEXR's files have one current frame buffer, so a thread needs its
/// own.
struct TileView {
  ExrInputStream stream;
  Imf::TiledInputFile image;
  explicit TileView(const InputFile& file) : stream(file), image(stream, 0) {}
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
  void read_tile(int column, int row, Map& map) const {
    std::unique_ptr<TileView> view = take_view();
    const Imath::V2i origin(column * m_layout.info.size, row * m_layout.info.size);
    view->image.setFrameBuffer(frame_of(map, origin, m_layout.channels));
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

} // namespace haarlight::image
