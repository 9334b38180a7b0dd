#pragma once
// How the maps of a set lie in an EXR image.
// For the sources of this folder only: it shows OpenEXR's headers.

#include <image/exr_pixels.h>

#include <wavelet/file/input_file.h>
#include <wavelet/tree/map_set.h>

#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>

namespace haarlight::image {

/// The maps described by an EXR's header.
struct ExrMapLayout {
  Imf::Header header;
  wavelet::SetInfo info;
  bool plain = false; ///< one map as an ordinary picture; else one tile per map
  RgbChannels channels;
};

/// @throws Error(Input) for a header that is neither one of a map set nor of a square picture of a
///         power of two of pixels a side
ExrMapLayout read_map_layout(const InputFile& file);

/// The frame buffer of a map whose upper left corner is at `origin` of the image. A grey image
/// fills the first channel only.
Imf::FrameBuffer frame_of(wavelet::Map& map, const Imath::V2i& origin, const RgbChannels& channels);

} // namespace haarlight::image
