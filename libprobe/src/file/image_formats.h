#pragma once
// Image formats, recognised by the first bytes of a file and never by its name.

#include <wavelet/base/image.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace haarlight::probe {

/// Pixels an image may have at most (16384 × 8192); readers refuse more before they allocate.
inline constexpr std::size_t max_pixels = std::size_t{1} << 27;

/// The formats that are read, besides Radiance RGBE.
enum class ImageFormat { OpenExr, Pfm, Tiff, Png, Jpeg };

/// All accepted formats, for messages.
inline constexpr const char* accepted_formats =
    "Radiance RGBE, OpenEXR, PFM, TIFF, PNG and JPEG are accepted";

/// @throws Error(Input) naming the format found, where it is known, and the accepted ones
ImageFormat detect_format(std::span<const std::byte> bytes, const std::string& path);

/// The format's name in messages.
const char* format_name(ImageFormat format);

/// Reads a portable float map (.pfm): a text header, then rows of 32-bit floats from the bottom up.
/// `PF` has three channels, `Pf` one, `PF4` four, of which the last is dropped. A negative scale
/// means little-endian values, a positive one big-endian; values are multiplied by its magnitude.
/// The header ends with one white-space character, or with CR LF if its first line does. Reference:
/// Debevec, "PFM Portable FloatMap Image Format", 2001.
/// @param notes receives a sentence about each change of the values
/// @throws Error(Input) if malformed, or if the size of the file does not match the header
Image read_pfm(std::span<const std::byte> bytes, const std::string& path,
               std::vector<std::string>& notes);

} // namespace haarlight::probe
