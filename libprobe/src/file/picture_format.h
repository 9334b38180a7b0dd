#pragma once
// Image formats, known by the first bytes of a file and never by its name.

#include <cstddef>
#include <span>
#include <string>

namespace haarlight::probe {

/// The formats that are read, besides Radiance RGBE.
enum class PictureFormat { OpenExr, Pfm, Tiff, Png, Jpeg };

/// All accepted formats, for messages.
inline constexpr const char* accepted_formats =
    "Radiance RGBE, OpenEXR, PFM, TIFF, PNG and JPEG are accepted";

/// @throws Error(Input) naming the format found, where it is known, and the accepted ones
PictureFormat detect_format(std::span<const std::byte> bytes, const std::string& path);

/// The format's name in messages.
const char* format_name(PictureFormat format);

} // namespace haarlight::probe
