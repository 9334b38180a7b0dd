#pragma once
// Ordinary pictures as EXR: scanlines, named float channels, ZIP.

#include <wavelet/base/image.h>
#include <wavelet/file/output_file.h>

#include <string>
#include <utility>
#include <vector>

namespace haarlight::image {

/// One channel of an image, somewhere in memory: pixel (x, y) is first[(y·width + x)·stride].
struct ExrChannel {
  std::string name; ///< as in "R" or "N.X"
  const float* first = nullptr;
  int stride = 1; ///< floats from one pixel to the next
};

struct ExrImage {
  int width = 0;
  int height = 0;
  std::vector<ExrChannel> channels;
  std::vector<std::pair<std::string, std::string>> texts; ///< header attributes by name
  std::vector<std::pair<std::string, double>> numbers;
  std::vector<std::pair<std::string, int>> integers;
};

/// Writes the image whole or not at all; the same bytes for any number of threads.
/// @throws Error(Output)
void write_exr(const std::string& path, const ExrImage& image);

/// A picture as channels R, G, B. @throws Error(Output)
void write_exr(const std::string& path, const Image& picture);

/// Commits an EXR file after reading back that it is complete. @throws Error(Output)
void commit_exr(OutputFile& file);

/// The display window of a single-part EXR image of scanlines or tiles, black outside of the data
/// window: channels R, G, B, else those of the only layer that has all three, else Y.
/// @throws Error(Input) for other images, and for damaged files before memory is allocated for them
Image read_exr(const std::string& path);

} // namespace haarlight::image
