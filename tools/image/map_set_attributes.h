#pragma once
// A set's SetInfo as EXR header attributes, and back.
// For the sources of this folder only: it shows OpenEXR's headers.

#include <wavelet/tree/map_set.h>

#include <OpenEXR/ImfHeader.h>

#include <string>

namespace haarlight::image {

/// The sphere map of every set, as the attribute haarlight:domain says it.
inline constexpr const char* domain_name = "octahedral equal-area (Clarberg 2008)";

/// True if the header is one of a map set of this toolkit.
bool has_set_attributes(const Imf::Header& header);

void set_attributes(Imf::Header& header, const wavelet::SetInfo& info);

/// @param path for errors
/// @throws Error(Input) for missing or unknown attributes and for ones that contradict each other
wavelet::SetInfo read_attributes(const Imf::Header& header, const std::string& path);

} // namespace haarlight::image
