#include <image/map_set_exr.h>

#include <image/exr_map_layout.h>
#include <image/exr_stream.h>

#include <wavelet/error.h>

#include <OpenEXR/ImfInputFile.h>
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

void spread_grey(Map& map) {
  for (std::size_t i = 0; i < map.rgb.size(); i += 3)
    map.rgb[i + 2] = map.rgb[i + 1] = map.rgb[i];
}

} // namespace

class ExrMapSource::Reader {
public:
  explicit Reader(const std::string& path) : m_file(path), m_layout(read_map_layout(m_file)) {
    if (m_layout.plain)
      require_complete<Imf::InputFile>();
    else
      require_complete<Imf::TiledInputFile>();
  }

  const SetInfo& info() const { return m_layout.info; }

  Map make(int column, int row) const {
    Map map(m_layout.info.size);
    with_input_errors(m_file.path(), [&] {
      if (m_layout.plain)
        read_plain(map);
      else
        read_tile(column, row, map);
    });
    if (m_layout.grey())
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
    view.image.setFrameBuffer(frame_of(map, m_layout.origin, m_layout));
    view.image.readPixels(m_layout.origin.y, m_layout.origin.y + m_layout.info.size - 1);
  }

  void read_tile(int column, int row, Map& map) const {
    std::unique_ptr<TileView> view = take_view();
    const Imath::V2i origin(column * m_layout.info.size, row * m_layout.info.size);
    view->image.setFrameBuffer(frame_of(map, origin, m_layout));
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
