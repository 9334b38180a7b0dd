#pragma once
// Portable float maps (.pfm): a text header, then rows of 32-bit floats from the bottom up.
//
// `PF` has three channels, `Pf` one, `PF4` four, of which the last is dropped. A negative scale
// means little-endian values, a positive one big-endian; values are multiplied by its magnitude.
// The header ends with one white-space character, or with CR LF if its first line does.
// Reference: Debevec, "PFM Portable FloatMap Image Format", 2001.

#include <wavelet/base/image.h>

#include <span>
#include <string>
#include <vector>

namespace haarlight::probe {

/// @param notes receives a sentence about each change of the values
/// @throws Error(Input) if malformed, or if the size differs from what the header says
Image read_pfm(std::span<const std::byte> bytes, const std::string& path,
               std::vector<std::string>& notes);

} // namespace haarlight::probe
