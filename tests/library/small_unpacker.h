#pragma once
// A small independent reader of packed .haar files, written from libwavelet/FORMAT.md alone: it
// shares no code with the library, and makes maps by walking squares, not the mapped form.

#include <zstd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

class SmallUnpacker {
public:
  using Pixels = std::vector<std::array<float, 3>>;

  explicit SmallUnpacker(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    m_file.assign(std::istreambuf_iterator<char>(in), {});
    if (m_file.size() < 160 || m_file.substr(0, 8) != "\x89HAAP\r\n\x1a")
      throw std::runtime_error("no packed .haar file");
    m_levels = u32(32 + 32);
    m_channels = u32(32 + 36);
    m_width = u32(32 + 40) == 0 ? 2 : 4;
    m_text = frame(160, u32(24));
    std::size_t at = 160 + u32(24);
    for (std::uint32_t block = u32(28); block > 0; --block) {
      read_block(at);
      at += u32(at + 4);
    }
  }

  const std::string& text() const { return m_text; }
  std::uint32_t levels() const { return m_levels; }

  /// The map of tree number row · columns + column, row 0 first, 2^levels a side.
  Pixels map(std::size_t tree) const { return m_maps.at(tree); }

private:
  /// A square that will be filled once its level is reached.
  struct Square {
    std::size_t x, y;
    std::array<float, 3> average;
  };
  struct Tree {
    std::uint32_t nodes;
    float scale;
    std::vector<Square> squares;
    Pixels pixels;
  };

  std::uint32_t u32(std::size_t at) const {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;)
      value = value << 8U | static_cast<unsigned char>(m_file.at(at + i));
    return value;
  }
  static float f32(std::uint32_t bits) {
    float value = 0;
    std::memcpy(&value, &bits, 4);
    return value;
  }
  std::string frame(std::size_t at, std::size_t bytes) const {
    std::string content(ZSTD_getFrameContentSize(m_file.data() + at, bytes), '\0');
    if (ZSTD_decompress(content.data(), content.size(), m_file.data() + at, bytes) !=
        content.size())
      throw std::runtime_error("broken frame");
    return content;
  }

  void read_block(std::size_t at) {
    const std::size_t count = u32(at);
    std::vector<std::string> streams;
    std::size_t next = at + 16 + 4 * (3 + m_width * m_channels);
    for (std::size_t i = 0; i < 3 + m_width * m_channels; ++i) {
      const std::size_t bytes = u32(at + 16 + 4 * i);
      streams.push_back(frame(next, bytes));
      next += bytes;
    }
    std::vector<Tree> trees;
    for (std::size_t i = 0; i < count; ++i)
      trees.push_back(start(streams[0], i, count));
    std::size_t node = 0;
    std::size_t value = 0;
    for (std::uint32_t level = 0; level < m_levels; ++level)
      for (std::size_t i = 0; i < count; ++i)
        read_level(trees[i], streams, static_cast<unsigned char>(streams[1][level * count + i]),
                   level, node, value);
    for (Tree& tree : trees)
      m_maps.push_back(tree.pixels);
  }

  Tree start(const std::string& records, std::size_t i, std::size_t count) const {
    const auto field = [&](std::size_t word) {
      std::uint32_t bits = 0;
      for (std::size_t k = 4; k-- > 0;)
        bits = bits << 8U | static_cast<unsigned char>(records[(4 * word + k) * count + i]);
      return bits;
    };
    Tree tree = {field(0), f32(field(1)), {}, {}};
    const std::array<float, 3> mean = {f32(field(2)), f32(field(3)), f32(field(4))};
    tree.pixels.assign(std::size_t{1} << (2 * m_levels), mean);
    if (tree.nodes > 0)
      tree.squares.push_back({0, 0, mean});
    return tree;
  }

  /// Fills every quadrant with its average, and goes on where a quadrant has a node.
  void read_level(Tree& tree, const std::vector<std::string>& streams, unsigned form,
                  std::uint32_t level, std::size_t& node, std::size_t& value) {
    std::vector<Square> children;
    for (const Square& square : tree.squares) {
      const auto bits = static_cast<unsigned char>(streams[2][node++]);
      std::array<std::array<float, 3>, 3> d = {};
      for (unsigned m = 0; m < 3; ++m)
        if (((bits >> (4 + m)) & 1U) != 0)
          d[m] = coefficient(streams, form, value++, tree.scale);
      for (std::size_t q = 0; q < 4; ++q) {
        Square child = {2 * square.x + (q & 1U), 2 * square.y + (q >> 1U), square.average};
        const float sx = (q & 1U) != 0 ? -1 : 1;
        const float sy = (q & 2U) != 0 ? -1 : 1;
        for (std::size_t c = 0; c < 3; ++c)
          child.average[c] += sx * d[0][c] + sy * d[1][c] + sx * sy * d[2][c];
        fill(tree.pixels, child, level + 1);
        if (((bits >> q) & 1U) != 0)
          children.push_back(child);
      }
    }
    tree.squares = children;
  }

  void fill(Pixels& pixels, const Square& square, std::uint32_t level) const {
    const std::size_t side = std::size_t{1} << (m_levels - level);
    for (std::size_t y = square.y * side; y < (square.y + 1) * side; ++y)
      for (std::size_t x = square.x * side; x < (square.x + 1) * side; ++x)
        pixels[(y << m_levels) + x] = square.average;
  }

  std::array<float, 3> coefficient(const std::vector<std::string>& streams, unsigned form,
                                   std::size_t value, float scale) const {
    std::array<std::int64_t, 3> number = {};
    for (std::size_t i = 0; i < m_channels; ++i) {
      std::uint64_t code = 0;
      for (std::size_t k = m_width; k-- > 0;)
        code = code << 8U | static_cast<unsigned char>(streams[3 + m_width * i + k][value]);
      if (form == 0 && i == 0) // rotated left by one bit
        number[i] = static_cast<std::int64_t>(code >> 1U | (code & 1U) << (8 * m_width - 1));
      else
        number[i] = static_cast<std::int64_t>(code >> 1U) ^ -static_cast<std::int64_t>(code & 1U);
    }
    const std::int64_t step = form == 0 ? 1 : 1 + form / 64;
    const std::array<std::int64_t, 3> rgb = {number[0] + step * number[1], number[0],
                                             number[0] + step * number[2]};
    std::array<float, 3> result = {};
    for (std::size_t c = 0; c < 3; ++c)
      result[c] = scale * (form == 0 ? from_bits(static_cast<std::uint32_t>(rgb[c]))
                                     : std::ldexp(static_cast<float>(rgb[c]),
                                                  static_cast<int>(form % 64) - 25));
    return result;
  }

  float from_bits(std::uint32_t bits) const {
    if (m_width == 4)
      return f32(bits);
    const int exponent = static_cast<int>((bits >> 10U) & 31U);
    const auto fraction = static_cast<float>(bits & 1023U);
    const float size =
        exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
    return (bits & 0x8000U) != 0 ? -size : size;
  }

  std::string m_file;
  std::string m_text;
  std::uint32_t m_levels = 0;
  std::size_t m_channels = 0;
  std::size_t m_width = 0;
  std::vector<Pixels> m_maps;
};
