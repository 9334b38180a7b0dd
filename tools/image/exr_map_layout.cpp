#include <image/exr_map_layout.h>

#include <image/exr_header.h>
#include <image/map_set_attributes.h>

#include <wavelet/error.h>

#include <OpenEXR/ImfChannelList.h>

#include <bit>
#include <cstdint>

namespace haarlight::image {
namespace {

using wavelet::SetInfo;

/// R, G and B, or Y for all three.
std::array<std::string, 3> channel_names(const Imf::Header& header, const std::string& path) {
  const Imf::ChannelList& channels = header.channels();
  std::array<std::string, 3> names = {"R", "G", "B"};
  if (channels.findChannel("R") == nullptr && channels.findChannel("Y") != nullptr)
    names.fill("Y");
  for (const std::string& name : names) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (channel == nullptr)
      throw_input_error(path, "has no channel " + name + "; R, G, B or Y are needed");
    if (channel->xSampling != 1 || channel->ySampling != 1 || channel->type == Imf::UINT)
      throw_input_error(path, "channel " + name + " is subsampled or of integers");
  }
  return names;
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

ExrMapLayout read_map_layout(const InputFile& file) {
  const Imf::Header header = read_exr_header(file);
  ExrMapLayout layout;
  layout.channels = channel_names(header, file.path());
  layout.plain = !has_set_attributes(header);
  layout.info = layout.plain ? plain_info(header, file) : read_attributes(header, file.path());
  layout.origin = header.dataWindow().min;
  if (layout.plain)
    return layout;
  if (!header.hasTileDescription())
    throw_input_error(file.path(), "is a map set without tiles; one tile per map is needed");
  check_tiles(header, layout.info, file.path());
  return layout;
}

Imf::FrameBuffer frame_of(wavelet::Map& map, const Imath::V2i& origin, const ExrMapLayout& layout) {
  Imf::FrameBuffer frame;
  for (std::size_t c = 0; c < (layout.grey() ? 1U : 3U); ++c)
    frame.insert(layout.channels[c],
                 Imf::Slice::Make(Imf::FLOAT, map.rgb.data() + c, origin, map.size, map.size,
                                  3 * sizeof(float),
                                  3 * sizeof(float) * static_cast<std::size_t>(map.size)));
  return frame;
}

} // namespace haarlight::image
