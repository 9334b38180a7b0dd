#pragma once
// Signed values as colours.

#include <wavelet/base/image.h>

#include <vector>

namespace haarlight::image {

/// Signed values on a square, row by row.
struct SignedField {
  int size = 0;
  std::vector<float> values;
};

/// Of every four values the one farthest from zero. @param field of even size
SignedField halved(const SignedField& field);

/// Black at 0, red to yellow up to 1, blue to cyan down to −1; for display.
Rgb false_colour(float t);

/// The field in false colours of the cube root of each value divided by the largest magnitude, each
/// value `scale` × `scale` pixels, above a legend of 22 rows: a bar of all colours, and their
/// values (320 pixels across have room for them).
Image false_colour_picture(const SignedField& field, int scale);

} // namespace haarlight::image
