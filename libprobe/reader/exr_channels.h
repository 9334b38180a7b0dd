#pragma once
// Which channels of an OpenEXR file are the colours.

#include "decoder.h"

#include <OpenEXR/ImfMultiPartInputFile.h>

#include <string>

namespace haarlight::probe::reader {

/// The channels of one layer of one part, by their role. Names are complete, empty if missing.
struct ExrChannels {
  int part = 0;
  std::string layer; ///< what precedes the last dot of the names; empty if nothing does
  std::string red, green, blue;
  std::string luminance, red_chroma, blue_chroma; ///< Y, RY, BY
};

/// Looks over all parts for R, G, B without a layer; then for one layer with these; then for Y
/// without a layer; then for one layer with Y. Letter case does not matter; Red, Green and Blue
/// count too. Deep parts are left out.
/// @throws Refusal that lists parts and layers if there is none, or more than one
ExrChannels find_colours(const Imf::MultiPartInputFile& file, const ImageChoice& choice);

} // namespace haarlight::probe::reader
