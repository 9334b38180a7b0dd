#pragma once
// Pictures of any format, brought to one form: linear RGB, finite, not negative.

#include <wavelet/base/image.h>

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

/// Which image of a file with several is meant; empty texts leave the choice to the reader.
struct ImageChoice {
  std::string layer; ///< OpenEXR: what precedes the last dot of the channel names
  std::string part;  ///< OpenEXR: name or number of a part; TIFF: number of a page; from 0
};

/// Reads Radiance RGBE, OpenEXR, PFM, TIFF, PNG and JPEG, known by their content. Grey becomes RGB;
/// values encoded for display are made linear, other primaries are converted to Rec. 709,
/// orientation tags are obeyed; negative values are set to 0. Notes state what was done. OpenEXR:
/// the data window is placed in the display window. Formats other than RGBE and PFM are decoded by
/// a separate program with limits of memory and time.
/// @throws Error(Input) if the file is missing, of no accepted format, damaged, truncated, too
/// large,
///         ambiguous (several layers or parts hold colours and none is chosen), or holds a NaN or
///         an infinity, whose pixel is named; std::runtime_error if the program cannot be started
LoadedImage read_image(const std::string& path, const ImageChoice& choice = {});

/// What read_image does to pixels: refuses NaN and infinities, clamps negative values.
/// @return values that were negative
/// @throws Error(Input)
std::size_t clean_pixels(Image& image, const std::string& path);

} // namespace haarlight::probe
