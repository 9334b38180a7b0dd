#pragma once
// PNG images of 8 bits per channel, sRGB, and the exposure of images for display.

#include <wavelet/base/image.h>

#include <string>

namespace haarlight::image {

/// The factor that makes a picture's mean luminance middle grey (0.18), negative values counting as
/// black; 1 for a black picture.
float middle_grey_gain(const Image& picture);

/// Multiplies all values.
void brighten(Image& picture, float gain);

enum class ToneMap {
  Clamp, ///< values above 1 become 1
  Filmic ///< a smooth shoulder and toe (Narkowicz 2015, "ACES filmic tone mapping curve")
};

struct PngOptions {
  double exposure = 0; ///< stops; values are multiplied by 2^exposure first
  ToneMap tone_map = ToneMap::Clamp;
};

/// Applies exposure and tone map: linear values for display, from 0 to 1.
void tone_map(Image& picture, const PngOptions& options);

/// The 8-bit sRGB code of a linear value; not-a-number and negative values give 0.
unsigned char srgb_code(float linear);
/// The linear value of a code; srgb_code() of it is the code again.
float srgb_value(unsigned char code);

/// A PNG file in memory; bytes depend on picture and options only. @throws Error(Output)
std::string png_bytes(const Image& picture, const PngOptions& options = {});

/// Writes the picture whole or not at all; bytes depend on picture and options only.
/// @throws Error(Output)
void write_png(const std::string& path, const Image& picture, const PngOptions& options = {});

/// Any PNG, transparency over black. @throws Error(Input)
Image read_png(const std::string& path);

} // namespace haarlight::image
