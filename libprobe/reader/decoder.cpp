#include "decoder.h"

namespace haarlight::probe::reader {
namespace {

/// Integers of a TIFF header, in its byte order; 0 beyond the end.
class ExifBytes {
public:
  explicit ExifBytes(std::span<const std::byte> bytes) : m_bytes(bytes) { m_little = at(0) == 'I'; }

  unsigned at(std::size_t offset) const {
    return offset < m_bytes.size() ? std::to_integer<unsigned>(m_bytes[offset]) : 0;
  }
  unsigned u16(std::size_t o) const {
    return m_little ? at(o) | at(o + 1) << 8 : at(o) << 8 | at(o + 1);
  }
  unsigned u32(std::size_t o) const {
    return m_little ? u16(o) | u16(o + 2) << 16 : u16(o) << 16 | u16(o + 2);
  }

private:
  std::span<const std::byte> m_bytes;
  bool m_little = false;
};

} // namespace

std::string first_line(const std::string& text) {
  return text.substr(0, text.find_first_of("\r\n"));
}

void reject_choice(const ImageChoice& choice) {
  if (!choice.layer.empty() || !choice.part.empty())
    throw DecodeError("has no layers or parts to choose from");
}

void check_pixels(std::uint64_t width, std::uint64_t height) {
  if (width < 1 || height < 1)
    throw DecodeError("has no pixels");
  if (width > max_pixels || height > max_pixels || width * height > max_pixels)
    throw DecodeError("has " + std::to_string(width) + " x " + std::to_string(height) +
                      " pixels, at most " + std::to_string(max_pixels) + " are read");
}

void check_file_size(const Task& task, std::uint64_t raw_bytes, std::uint64_t ratio) {
  if (raw_bytes / ratio > task.bytes.size())
    throw DecodeError("is cut short: its pixels take " + std::to_string(raw_bytes / ratio) +
                      " bytes at least, the file has " + std::to_string(task.bytes.size()));
}

Image upright(Image stored, unsigned orientation) {
  if (orientation < 2 || orientation > 8)
    return stored;
  const bool transposed = orientation >= 5;
  const bool right_to_left = orientation == 2 || orientation == 3 || orientation == 7 ||
                             orientation == 8; // along the stored rows
  const bool bottom_up = orientation == 3 || orientation == 4 || orientation == 6 ||
                         orientation == 7; // along the stored columns
  Image result(transposed ? stored.height : stored.width,
               transposed ? stored.width : stored.height);
  for (int y = 0; y < stored.height; ++y)
    for (int x = 0; x < stored.width; ++x) {
      const int across = right_to_left ? stored.width - 1 - x : x;
      const int down = bottom_up ? stored.height - 1 - y : y;
      result.set(transposed ? down : across, transposed ? across : down, stored.at(x, y));
    }
  return result;
}

unsigned exif_orientation(std::span<const std::byte> exif) {
  constexpr unsigned orientation_tag = 0x0112;
  constexpr unsigned short_type = 3;
  const ExifBytes bytes(exif);
  const std::size_t directory = bytes.u32(4);
  const unsigned entries = bytes.u16(directory);
  for (unsigned i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * std::size_t{i};
    if (entry + 12 > exif.size())
      return 1;
    if (bytes.u16(entry) == orientation_tag && bytes.u16(entry + 2) == short_type)
      return bytes.u16(entry + 8);
  }
  return 1;
}

} // namespace haarlight::probe::reader
