#pragma once
// A small independent reader of .haar files, written from libwavelet/FORMAT.md alone: it shares no
// code with the library, and reads by walking squares instead of links.

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

class SmallReader {
public:
  explicit SmallReader(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    m_bytes.assign(std::istreambuf_iterator<char>(in), {});
    if (m_bytes.size() < 128 || m_bytes.substr(0, 8) != "\x89HAAR\r\n\x1a" || u32(8) != 1)
      throw std::runtime_error("no .haar file of version 1");
  }

  std::uint32_t levels() const { return u32(32); }
  std::uint32_t columns() const { return u32(48); }
  std::uint32_t rows() const { return u32(52); }
  std::string text() const { return m_bytes.substr(u64(80), u64(88)); }

  /// The map of one tree, row 0 first, 2^levels a side.
  std::vector<std::array<float, 3>> map(std::uint32_t column, std::uint32_t row) const {
    const std::size_t entry = u64(64) + 40ULL * (row * columns() + column);
    const std::size_t side = std::size_t{1} << levels();
    std::vector<std::array<float, 3>> pixels(side * side);
    const std::array<float, 3> mean = {f32(entry + 24), f32(entry + 28), f32(entry + 32)};
    fill(entry, u32(entry + 16) > 0 ? 0 : -1, 0, 0, 0, mean, pixels);
    return pixels;
  }

private:
  std::uint32_t u32(std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(m_bytes.at(at + i)))
               << (8 * i);
    return value;
  }
  std::uint64_t u64(std::size_t at) const {
    return u32(at) | static_cast<std::uint64_t>(u32(at + 4)) << 32U;
  }
  float f32(std::size_t at) const {
    const std::uint32_t bits = u32(at);
    float value = 0;
    std::memcpy(&value, &bits, 4);
    return value;
  }
  float f16(std::size_t at) const {
    const std::uint32_t bits = u32(at) & 0xffffU;
    const int exponent = static_cast<int>((bits >> 10U) & 31U);
    const auto fraction = static_cast<float>(bits & 1023U);
    const float size =
        exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
    return (bits & 0x8000U) != 0 ? -size : size;
  }

  float coefficient(std::size_t entry, long node, unsigned m, unsigned channel) const {
    const std::size_t n = u32(entry + 16);
    const std::size_t start = u64(entry) + 4 * (levels() + 1 + n);
    const std::size_t index =
        (static_cast<std::size_t>(node) * 3 + m) * u32(36) + (u32(36) == 3 ? channel : 0);
    return f32(entry + 20) * (u32(40) == 0 ? f16(start + 2 * index) : f32(start + 4 * index));
  }

  long child(std::size_t entry, long node, unsigned q) const {
    const std::uint32_t link =
        u32(u64(entry) + 4 * (levels() + 1 + static_cast<std::size_t>(node)));
    if (((link >> q) & 1U) == 0)
      return -1;
    long index = link / 16;
    for (unsigned before = 0; before < q; ++before)
      index += (link >> before) & 1U;
    return index;
  }

  void fill(std::size_t entry, long node, std::uint32_t level, std::size_t x, std::size_t y,
            const std::array<float, 3>& mean, std::vector<std::array<float, 3>>& pixels) const {
    if (level == levels()) {
      pixels[(y << levels()) + x] = mean;
      return;
    }
    for (unsigned q = 0; q < 4; ++q) {
      std::array<float, 3> value = mean;
      const float sx = (q & 1U) != 0 ? -1 : 1;
      const float sy = (q & 2U) != 0 ? -1 : 1;
      for (unsigned c = 0; c < 3 && node >= 0; ++c)
        value[c] += sx * coefficient(entry, node, 0, c) + sy * coefficient(entry, node, 1, c) +
                    sx * sy * coefficient(entry, node, 2, c);
      fill(entry, node >= 0 ? child(entry, node, q) : -1, level + 1, 2 * x + (q & 1U),
           2 * y + (q >> 1U), value, pixels);
    }
  }

  std::string m_bytes;
};
