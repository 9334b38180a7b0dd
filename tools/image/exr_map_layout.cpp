#include <image/exr_map_layout.h>

#include <image/exr_header.h>
#include <image/map_set_attributes.h>

#include <wavelet/base/error.h>

#include <bit>
#include <cstdint>

namespace haarlight::image {
namespace {

using wavelet::SetInfo;

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

} // namespace

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

Imf::FrameBuffer frame_of(wavelet::Map& map, const Imath::V2i& origin,
                          const RgbChannels& channels) {
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < (channels.grey() ? 1U : 3U); ++c)
    frame.insert(channels.names[c],
                 Imf::Slice::Make(Imf::FLOAT, map.rgb.data() + c, origin, map.size, map.size,
                                  3 * sizeof(float),
                                  3 * sizeof(float) * static_cast<std::size_t>(map.size)));
  return frame;
}

} // namespace haarlight::image
