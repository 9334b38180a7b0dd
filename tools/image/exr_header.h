#pragma once
// A look at an EXR file before OpenEXR sees it.
// For the sources of this folder only: it shows OpenEXR's headers.

#include <wavelet/input_file.h>

#include <OpenEXR/ImfHeader.h>

namespace haarlight::image {

/// The header of a single-part EXR image, read without believing sizes in it: its attributes lie
/// within the file, and the file is long enough for the table of its tiles or lines.
/// @throws Error(Input)
Imf::Header read_exr_header(const InputFile& file);

} // namespace haarlight::image
