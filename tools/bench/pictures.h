#pragma once
// Pictures of a comparison, as data URIs of PNG files.

#include <bench/measure.h>

#include <string>

namespace haarlight::bench {

/// The part of a film that is shown: its middle, at most 128 × 128 pixels.
struct Crop {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

Crop crop_of(const Image& picture);

/// An exhibit's part of the film, tone-mapped with the exposure that suits the reference.
std::string picture_uri(const PairResult& pair, const Image& picture);

/// The relative error of luminance, (x − r)/sqrt(r² + ε), in false colours of the root of its size:
/// black none, yellow + 100 % or more, cyan − 100 %; white where no object is.
std::string error_uri(const PairResult& pair, const Image& picture);

/// The colours of error_uri() from − 100 % to + 100 %, linear in the root of the error.
std::string legend_uri();

} // namespace haarlight::bench
