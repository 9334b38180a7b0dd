#include <probe/rgbe.h>

#include <wavelet/file/output_file.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace haarlight::probe {
namespace {

using Bytes = std::vector<std::uint8_t>;
using RgbePixel = std::array<std::uint8_t, 4>;

void append_text(Bytes& out, const std::string& text) {
  out.insert(out.end(), text.begin(), text.end());
}

std::string rgbe_header_text(const Image& image, const std::vector<std::string>& comments) {
  std::string text = "#?RADIANCE\n";
  for (const auto& comment : comments) {
    assert(comment.find('\n') == std::string::npos);
    text += "# " + comment + "\n";
  }
  return text + "FORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height) + " +X " +
         std::to_string(image.width) + "\n";
}

/// Equal bytes from `at` on, 127 at most.
std::size_t run_length(const Bytes& bytes, std::size_t at) {
  std::size_t length = 1;
  while (length < 127 && at + length < bytes.size() && bytes[at + length] == bytes[at])
    ++length;
  return length;
}

/// One component of a scanline: runs of four and more as a count and a value, the rest as they are.
void append_runs(Bytes& out, const Bytes& component) {
  for (std::size_t x = 0; x < component.size();) {
    std::size_t plain = 0;
    std::size_t run = 0;
    while (plain < 128 && x + plain < component.size() &&
           (run = run_length(component, x + plain)) < 4)
      plain = std::min<std::size_t>(plain + run, 128);
    if (plain > 0) {
      out.push_back(static_cast<std::uint8_t>(plain));
      out.insert(out.end(), component.begin() + static_cast<std::ptrdiff_t>(x),
                 component.begin() + static_cast<std::ptrdiff_t>(x + plain));
      x += plain;
    } else {
      out.push_back(static_cast<std::uint8_t>(128 + run));
      out.push_back(component[x]);
      x += run;
    }
  }
}

void append_run_lengths(Bytes& out, const std::vector<RgbePixel>& line) {
  out.insert(out.end(), {2, 2, static_cast<std::uint8_t>(line.size() >> 8U),
                         static_cast<std::uint8_t>(line.size() & 255U)});
  Bytes component(line.size());
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t x = 0; x < line.size(); ++x)
      component[x] = line[x][c];
    append_runs(out, component);
  }
}

/// The nearest RGBE value of a colour: mantissas are rounded, values of 2^127 and more clamped.
RgbePixel encode_rgbe(const Rgb& colour) {
  const float largest = colour.maxCoeff();
  if (!(largest > 1e-38F))
    return {0, 0, 0, 0};
  int exponent = 0;
  std::frexp(largest, &exponent);
  // The largest mantissa may round up to 256, which is the next exponent's 128.
  if (std::nearbyint(std::ldexp(static_cast<double>(largest), 8 - exponent)) > 255)
    ++exponent;
  exponent = std::min(exponent, 127);
  if (exponent + 128 < 1)
    return {0, 0, 0, 0};
  RgbePixel pixel{};
  for (int c = 0; c < 3; ++c) {
    const double mantissa =
        std::nearbyint(std::ldexp(static_cast<double>(colour[c]), 8 - exponent));
    pixel[static_cast<std::size_t>(c)] =
        static_cast<std::uint8_t>(std::clamp(mantissa, 0.0, 255.0));
  }
  pixel[3] = static_cast<std::uint8_t>(exponent + 128);
  return pixel;
}

void append_scanline(Bytes& out, const Image& image, int y) {
  std::vector<RgbePixel> line(static_cast<std::size_t>(image.width));
  for (int x = 0; x < image.width; ++x)
    line[static_cast<std::size_t>(x)] = encode_rgbe(image.at(x, y));
  if (image.width >= 8 && image.width <= 32767) {
    append_run_lengths(out, line);
    return;
  }
  for (const auto& pixel : line)
    out.insert(out.end(), pixel.begin(), pixel.end());
}

} // namespace

void write_rgbe(const std::string& path, const Image& image,
                const std::vector<std::string>& comments) {
  OutputFile file(path);
  Bytes out;
  append_text(out, rgbe_header_text(image, comments));
  for (int y = 0; y < image.height; ++y)
    append_scanline(out, image, y);
  file.write(out.data(), out.size());
  file.commit();
}

} // namespace haarlight::probe
