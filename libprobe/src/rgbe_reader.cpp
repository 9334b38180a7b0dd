#include <probe/rgbe.h>

#include "rgbe_header.h"

#include <wavelet/error.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace haarlight::probe {
namespace {

using Pixel = std::array<std::uint8_t, 4>;

/// Walks through the scanlines of a picture, never past the end of its bytes.
class ScanlineReader {
public:
  ScanlineReader(std::span<const std::byte> bytes, const std::string& path, std::size_t position)
      : m_bytes(bytes), m_path(path), m_position(position) {}

  /// Reads the next scanline, of whichever coding.
  void read(std::vector<Pixel>& line) {
    const bool may_be_new = line.size() >= 8 && line.size() <= 32767;
    if (may_be_new && m_bytes.size() - m_position >= 4 && peek(0) == 2 && peek(1) == 2 &&
        peek(2) < 128)
      read_components(line);
    else
      read_pixels(line);
    ++m_line;
  }

private:
  std::uint8_t peek(std::size_t ahead) const {
    return std::to_integer<std::uint8_t>(m_bytes[m_position + ahead]);
  }

  [[noreturn]] void fail(const std::string& what, std::size_t offset) const {
    throw_input_error(m_path, "scanline " + std::to_string(m_line) + " " + what, offset);
  }

  void need(std::size_t count) const {
    if (m_bytes.size() - m_position < count)
      fail("is cut short: the file ends here", m_bytes.size());
  }

  std::uint8_t next() {
    need(1);
    return std::to_integer<std::uint8_t>(m_bytes[m_position++]);
  }

  Pixel next_pixel() {
    need(4);
    Pixel pixel;
    std::memcpy(pixel.data(), m_bytes.data() + m_position, 4);
    m_position += 4;
    return pixel;
  }

  /// New run lengths: the line's four components one after the other.
  void read_components(std::vector<Pixel>& line) {
    const std::size_t length = std::size_t{peek(2)} << 8U | peek(3);
    if (length != line.size())
      fail("says it holds " + std::to_string(length) + " pixels, the picture's have " +
               std::to_string(line.size()),
           m_position);
    m_position += 4;
    for (std::size_t component = 0; component < 4; ++component)
      read_component(line, component);
  }

  void read_component(std::vector<Pixel>& line, std::size_t component) {
    for (std::size_t x = 0; x < line.size();) {
      const std::size_t start = m_position;
      const unsigned code = next();
      const bool run = code > 128;
      const std::size_t count = run ? code - 128 : code;
      if (count == 0 || count > line.size() - x)
        fail("has a run of " + std::to_string(count) + " where 1 to " +
                 std::to_string(line.size() - x) + " pixels are left",
             start);
      copy_component(line, component, x, count, run);
      x += count;
    }
  }

  void copy_component(std::vector<Pixel>& line, std::size_t component, std::size_t x,
                      std::size_t count, bool run) {
    need(run ? 1 : count);
    for (std::size_t i = 0; i < count; ++i)
      line[x + i][component] = peek(run ? 0 : i);
    m_position += run ? 1 : count;
  }

  /// Flat pixels, among which (1, 1, 1, n) repeats the one before n times (old run lengths);
  /// repeats in a row are the bytes of one count, the least first.
  void read_pixels(std::vector<Pixel>& line) {
    unsigned shift = 0;
    for (std::size_t x = 0; x < line.size();) {
      const std::size_t start = m_position;
      const Pixel pixel = next_pixel();
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
        line[x++] = pixel;
        shift = 0;
        continue;
      }
      const std::uint64_t count = shift < 32 ? std::uint64_t{pixel[3]} << shift : 0;
      if (x == 0 || shift >= 32 || count > line.size() - x)
        fail("has a repeat that does not fit", start);
      std::fill_n(line.begin() + static_cast<std::ptrdiff_t>(x), count, line[x - 1]);
      x += count;
      shift += 8;
    }
  }

  std::span<const std::byte> m_bytes;
  const std::string& m_path;
  std::size_t m_position;
  std::size_t m_line = 0;
};

/// What turns mantissas into values: powers of two, and the exposure undone.
struct Decoder {
  std::array<double, 256> power{};
  std::array<double, 3> scale{};
  bool xyz = false;

  explicit Decoder(const RgbeHeader& header) : xyz(header.xyz) {
    for (int e = 1; e < 256; ++e)
      power[static_cast<std::size_t>(e)] = std::ldexp(1.0, e - 136);
    for (std::size_t c = 0; c < 3; ++c)
      scale[c] = 1.0 / header.exposure[c];
  }

  Rgb operator()(const Pixel& p) const {
    const double unit = power[p[3]];
    const Eigen::Array3d v(p[0] * unit * scale[0], p[1] * unit * scale[1], p[2] * unit * scale[2]);
    return (xyz ? to_rec709(v) : v).cast<float>();
  }

  /// CIE XYZ, white D65 (IEC 61966-2-1).
  static Eigen::Array3d to_rec709(const Eigen::Array3d& v) {
    return {3.2404542 * v[0] - 1.5371385 * v[1] - 0.4985314 * v[2],
            -0.9692660 * v[0] + 1.8760108 * v[1] + 0.0415560 * v[2],
            0.0556434 * v[0] - 0.2040259 * v[1] + 1.0572252 * v[2]};
  }
};

/// Fewest bytes a scanline can take in any coding, so that a short file cannot ask for much memory.
std::uint64_t least_scanline_bytes(std::uint64_t length) {
  std::uint64_t old_bytes = 4;
  for (std::uint64_t covered = 1, reach = 255; covered < length; reach *= 256) {
    covered += reach;
    old_bytes += 4;
  }
  if (length < 8 || length > 32767)
    return old_bytes;
  return std::min(old_bytes, 4 + 8 * ((length + 126) / 127));
}

void check_size(const RgbeHeader& header, std::size_t file_size, const std::string& path) {
  const std::uint64_t pixels = header.lines * header.length;
  if (pixels > max_pixels)
    throw_input_error(path,
                      "is said to have " + std::to_string(pixels) + " pixels, at most " +
                          std::to_string(max_pixels) + " are read",
                      header.size_offset);
  const std::uint64_t least = header.lines * least_scanline_bytes(header.length);
  if (file_size - header.data_offset < least)
    throw_input_error(path,
                      "is cut short: " + std::to_string(header.lines) + " scanlines of " +
                          std::to_string(header.length) + " pixels take " + std::to_string(least) +
                          " bytes at least, " + std::to_string(file_size - header.data_offset) +
                          " follow the header",
                      file_size);
}

} // namespace

Rgb decode_rgbe(const std::array<std::uint8_t, 4>& pixel) {
  static const Decoder decoder{RgbeHeader{}};
  return decoder(pixel);
}

Image read_rgbe(std::span<const std::byte> bytes, const std::string& path) {
  const RgbeHeader header = read_rgbe_header(bytes, path);
  check_size(header, bytes.size(), path);
  const Decoder decode(header);
  Image image(header.width(), header.height());
  ScanlineReader reader(bytes, path, header.data_offset);
  std::vector<Pixel> line(header.length);
  for (std::uint64_t s = 0; s < header.lines; ++s) {
    reader.read(line);
    for (std::uint64_t i = 0; i < header.length; ++i) {
      const auto [x, y] = header.place(s, i);
      image.set(x, y, decode(line[i]));
    }
  }
  return image;
}

} // namespace haarlight::probe
