#pragma once
// Pictures of any format, brought to one form: linear RGB, finite, not negative.

#include <probe/image.h>

#include <string>
#include <vector>

namespace haarlight::probe {

/// A picture and what an output made from it should say of its origin.
struct LoadedImage {
  Image image;
  std::string name;               ///< base name of the file
  std::string hash;               ///< of its bytes, 16 hexadecimal digits
  std::vector<std::string> notes; ///< what was changed on reading, a sentence each
};

/// Reads Radiance RGBE (known by its content), and through OpenImageIO, loaded when first needed,
/// everything that reads: OpenEXR, PFM, TIFF … Grey becomes RGB, alpha is dropped, values encoded
/// for display are made linear, negative ones are set to 0 and counted in a note.
/// @throws Error(Input) if the file is missing, no picture, truncated, too large, or holds a NaN or
///         an infinity, whose pixel is named
LoadedImage read_image(const std::string& path);

/// What read_image does to pixels: refuses NaN and infinities, clamps negative values.
/// @return values that were negative
/// @throws Error(Input)
std::size_t clean_pixels(Image& image, const std::string& path);

} // namespace haarlight::probe
