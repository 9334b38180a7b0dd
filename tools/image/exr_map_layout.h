#pragma once
// How the maps of a set lie in an EXR image.
// For the sources of this folder only: it shows OpenEXR's headers.

#include <wavelet/input_file.h>
#include <wavelet/map_set.h>

#include <OpenEXR/ImfFrameBuffer.h>

#include <array>
#include <string>

namespace haarlight::image {

/// What an EXR's header says of the maps in it.
struct ExrMapLayout {
  wavelet::SetInfo info;
  bool plain = false;                  ///< one map as an ordinary picture; else one tile per map
  Imath::V2i origin;                   ///< of the picture's pixels
  std::array<std::string, 3> channels; ///< R, G and B, or Y for all three

  bool grey() const { return channels[0] == channels[1]; }
};

/// @throws Error(Input) for a header that is neither one of a map set nor of a square picture of a
///         power of two of pixels a side
ExrMapLayout read_map_layout(const InputFile& file);

/// Where the pixels of a map go whose upper left corner is at `origin` of the image. A grey image
/// fills the first channel only.
Imf::FrameBuffer frame_of(wavelet::Map& map, const Imath::V2i& origin, const ExrMapLayout& layout);

} // namespace haarlight::image
