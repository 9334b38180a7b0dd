#pragma once
// Task, errors and checks common to the decoders of the reader program.

#include "file/external_reader.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace haarlight::probe::reader {

/// A file cannot be decoded; what() is a predicate whose subject is the file.
class DecodeError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The file to decode, and the choice of a layer or part.
struct Task {
  std::span<const std::byte> bytes;
  ImageChoice choice;
};

// The decoders. Each throws DecodeError, or dies by a fault of a decoder's library.
DecodedImage read_exr(const Task& task);
DecodedImage read_tiff(const Task& task);
DecodedImage read_png(const Task& task);
DecodedImage read_jpeg(const Task& task);

/// Lets the process allocate this much more from now on.
void allow_memory(std::uint64_t bytes);

/// Messages of libraries may have several lines; the first states the error.
std::string first_line(const std::string& text);

/// @throws DecodeError if the format has neither layers nor parts and one was chosen
void reject_choice(const ImageChoice& choice);

/// @throws DecodeError if the size is zero or larger than max_pixels
void check_pixels(std::uint64_t width, std::uint64_t height);

/// Refuses a file too short for its size, before the pixels are allocated.
/// @param raw_bytes of the uncompressed pixels
/// @param ratio largest number of raw bytes per byte of the file
void check_file_size(const Task& task, std::uint64_t raw_bytes, std::uint64_t ratio);

/// Applies an orientation to a stored image.
/// @param orientation EXIF and TIFF, 1 to 8: where row 0 and column 0 are shown; others count as 1
Image upright(Image stored, unsigned orientation);

/// The orientation that an EXIF block (a TIFF header and directories) states; 1 if none.
unsigned exif_orientation(std::span<const std::byte> exif);

} // namespace haarlight::probe::reader
