#pragma once
// The strict check of an EXR file that precedes OpenEXR, which may crash or allocate any amount of
// memory on damaged files.
// For the sources of this folder only: it shows OpenEXR's headers.

#include <wavelet/file/input_file.h>

#include <OpenEXR/ImfHeader.h>

#include <string>

namespace haarlight::image {

/// The header of a single-part image of scanlines or tiles, after all of the file but the
/// compressed pixels themselves has been checked: attributes have the sizes of their types and
/// occur once, the required ones are there, and the table of chunks is whole (check_exr_chunks()).
/// @throws Error(Input) otherwise, and for deep and multi-part images
Imf::Header read_exr_header(const InputFile& file);

/// A name from a file as it may appear in a message: control characters become `?`.
std::string printable(std::string name);

} // namespace haarlight::image
