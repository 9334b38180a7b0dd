#pragma once
// The colours of an EXR image of any program.
// For the sources of this folder only: it shows OpenEXR's headers.

#include <image/image.h>

#include <wavelet/file/input_file.h>

#include <OpenEXR/ImfHeader.h>

#include <array>
#include <string>

namespace haarlight::image {

/// The channels that hold red, green and blue; a grey image has one for all three.
struct RgbChannels {
  std::array<std::string, 3> names;

  bool grey() const { return names[0] == names[1]; }
};

/// R, G and B; else those of the only layer that has all three (`beauty.R` …); else Y.
/// @throws Error(Input) that lists the channels if there are none or several such layers, and for
///         channels that are subsampled or of integers, luminance with chroma, and
///         chromaticities other than those of Rec. 709
RgbChannels choose_channels(const Imf::Header& header, const std::string& path);

/// The size of the display window, which is the picture.
/// @throws Error(Input) if it is empty, too large, or shows nothing of the data window
Imath::V2i display_size(const Imf::Header& header, const std::string& path);

/// The picture in the display window: pixels outside of the data window are black.
/// @param header that of the file, by read_exr_header()
/// @throws Error(Input)
Picture read_rgb(const InputFile& file, const Imf::Header& header);

/// Copies the first channel of grey pixels to the other two.
void spread_grey(std::vector<float>& rgb);

} // namespace haarlight::image
