#pragma once
// Strict validation of an EXR file before OpenEXR reads it: OpenEXR may crash or allocate any
// amount of memory on damaged files. For the sources of this folder only: it shows OpenEXR's
// headers.

#include <wavelet/file/input_file.h>

#include <OpenEXR/ImfHeader.h>

#include <cstdint>
#include <string>

namespace haarlight::image {

/// Pixels an image may have at most.
inline constexpr std::int64_t most_exr_pixels = std::int64_t{1} << 28;

/// The header of a single-part image of scanlines or tiles, after everything in the file except the
/// compressed pixels has been checked: attributes have the sizes of their types and occur once, the
/// required ones are present, the table of chunks is complete, every chunk lies within the file, is
/// the one of its table entry, and is long enough to hold its pixels at the highest ratio of its
/// compression. So no reader allocates much more than a constant times the size of the file, or
/// reads past a chunk.
/// @throws Error(Input) otherwise, and for deep and multi-part images
Imf::Header read_exr_header(const InputFile& file);

/// A name from a file as it may appear in a message: control characters become `?`.
std::string printable(std::string name);

} // namespace haarlight::image
