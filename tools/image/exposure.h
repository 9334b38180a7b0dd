#pragma once
// How bright a picture should be shown.

#include <image/image.h>

namespace haarlight::image {

/// The factor that makes a picture's mean luminance middle grey (0.18), negative values counting as
/// black; 1 for a black picture.
float middle_grey_gain(const Picture& picture);

/// Multiplies all values.
void brighten(Picture& picture, float gain);

} // namespace haarlight::image
