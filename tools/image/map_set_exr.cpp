#include <image/map_set_exr.h>

#include <image/exr_stream.h>
#include <image/map_set_attributes.h>

#include <wavelet/base/error.h>
#include <wavelet/base/memory.h>
#include <wavelet/base/parallel.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <algorithm>
#include <cstring>

namespace haarlight::image {
namespace {

using wavelet::Map;
using wavelet::MapSource;
using wavelet::SetInfo;

constexpr std::size_t batch_bytes = std::size_t{64} << 20; ///< of maps held at once, if one fits

Imf::Header header_of(const SetInfo& info) {
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
    Imf::TiledOutputFile image(stream, header_of(info), threads);
    write_tiles(source, image, stream, meter, progress);
  }
  stream.rethrow();
  return {meter.result(), stream.size()};
}

void commit_exr(OutputFile& file) { file.commit(check_exr_complete); }

} // namespace haarlight::image
