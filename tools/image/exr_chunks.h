#pragma once
// The chunks (blocks of scanlines, or tiles) of an EXR file.
// For the sources of this folder only: it shows OpenEXR's headers.

#include <wavelet/file/input_file.h>

#include <OpenEXR/ImfHeader.h>

#include <cstdint>

namespace haarlight::image {

/// Pixels an image may have at most.
inline constexpr std::int64_t most_exr_pixels = std::int64_t{1} << 28;

/// Checks that the table of chunks that follows the header is whole, that every chunk lies within
/// the file, is the one its place in the table asks for, and is long enough to hold its pixels in
/// the densest way its compression permits. So no reader allocates much more than a constant times
/// the file's size, or reads past a chunk.
/// @param header one whose sanityCheck() has passed
/// @param table  offset of the table
/// @throws Error(Input)
void check_exr_chunks(const InputFile& file, const Imf::Header& header, bool tiled,
                      std::uint64_t table);

} // namespace haarlight::image
