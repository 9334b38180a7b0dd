#pragma once
// Image files decoded by OpenEXR, libtiff, libpng and libjpeg in a separate program, so that a
// crash of a decoder, or a file that makes it take all memory or time, ends in an Error.

#include "file/picture_format.h"

#include <probe/read_image.h>

#include <string>
#include <vector>

namespace haarlight::probe {

struct ForeignImage {
  Image image;                    ///< linear Rec. 709; values are not checked yet
  std::vector<std::string> notes; ///< how the values were interpreted, a sentence each
};

/// Starts the reader program on a file and waits for its result. The program runs under limits of
/// memory (by the size that the header of the file states) and of time (by the size of the file).
/// @throws Error(Input) if the file cannot be decoded, or the program crashes or exceeds a limit;
///         std::runtime_error if the program cannot be started
ForeignImage read_foreign_image(const std::string& path, PictureFormat format,
                                const ImageChoice& choice);

} // namespace haarlight::probe
