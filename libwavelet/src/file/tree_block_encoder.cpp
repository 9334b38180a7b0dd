#include "file/tree_block.h"
#include "file/zstd_frame.h"

#include <wavelet/file/input_file.h>

#include <cassert>
#include <cstring>
#include <limits>
#include <numeric>

namespace haarlight::wavelet {
namespace {

using Bytes = std::vector<std::byte>;

class BlockEncoder {
public:
  explicit BlockEncoder(std::span<const Tree> trees)
      : m_trees(trees), m_channels(static_cast<std::size_t>(trees[0].channels)),
        m_width(coefficient_bytes(trees[0].type)),
        m_streams(stream_count(trees[0].channels, trees[0].type)) {}

  EncodedBlock encode() {
    append_records();
    for (std::size_t l = 0; l < static_cast<std::size_t>(m_trees[0].levels); ++l)
      for (const Tree& tree : m_trees)
        append_level(tree, l);
    const std::uint64_t empty_nodes = count_empty_nodes(m_streams[2]).value();
    return {assemble(), empty_nodes};
  }

private:
  void append_records() {
    std::vector<TreeRecord> records;
    for (const Tree& tree : m_trees)
      records.push_back({static_cast<std::uint32_t>(tree.links.size()),
                         tree.scale,
                         {tree.mean[0], tree.mean[1], tree.mean[2]}});
    const auto bytes = std::as_bytes(std::span(records));
    for (std::size_t k = 0; k < sizeof(TreeRecord); ++k)
      for (std::size_t i = k; i < bytes.size(); i += sizeof(TreeRecord))
        m_streams[0].push_back(bytes[i]);
  }

  void append_level(const Tree& tree, std::size_t level) {
    const std::uint32_t begin = tree.level_begin[level];
    const std::uint32_t end = tree.level_begin[level + 1];
    const LevelForm form =
        tree.type == CoefficientType::Half ? choose_form(tree, begin, end) : LevelForm{};
    m_streams[1].push_back(std::byte{form.byte()});
    for (std::uint32_t node = begin; node < end; ++node) {
      std::uint32_t present = 0;
      for (unsigned m = 0; m < 3; ++m)
        if (is_present(tree, node, m)) {
          present |= 1U << m;
          if (m_width == 2)
            append_half(tree, node, m, form);
          else
            append_float(tree, node, m);
        }
      m_streams[2].push_back(static_cast<std::byte>((tree.links[node] & 15U) | present << 4U));
    }
  }

  const std::byte* place(const Tree& tree, std::uint32_t node, unsigned m) const {
    return tree.coefficients.data() +
           (3 * static_cast<std::size_t>(node) + m) * m_channels * m_width;
  }

  bool is_present(const Tree& tree, std::uint32_t node, unsigned m) const {
    const std::byte* p = place(tree, node, m);
    return std::any_of(p, p + m_channels * m_width, [](std::byte b) { return b != std::byte{0}; });
  }

  std::uint16_t half(const Tree& tree, std::uint32_t node, unsigned m, std::size_t channel) const {
    std::uint16_t bits = 0;
    std::memcpy(&bits, place(tree, node, m) + 2 * channel, 2);
    return bits;
  }

  /// The largest power of two, and then the largest step, that serve all coefficients of a level.
  LevelForm choose_form(const Tree& tree, std::uint32_t begin, std::uint32_t end) const {
    LevelForm form = {true, std::numeric_limits<int>::max(), 1};
    const auto visit = [&](const auto& see) {
      for (std::uint32_t node = begin; node < end; ++node)
        for (unsigned m = 0; m < 3; ++m)
          for (std::size_t c = 0; c < m_channels; ++c)
            see(half(tree, node, m, c),
                half(tree, node, m, std::min<std::size_t>(1, m_channels - 1)));
    };
    visit([&](std::uint16_t bits, std::uint16_t) {
      if (bits == 0x8000)
        form.integers = false; // an integer has no negative zero
      if (bits != 0)
        form.exponent = std::min(form.exponent, DyadicHalf(bits).exponent);
    });
    if (!form.integers || form.exponent == std::numeric_limits<int>::max())
      return LevelForm{};
    int divisor = 0;
    visit([&](std::uint16_t bits, std::uint16_t green) {
      const std::int64_t value = integer(bits, form.exponent);
      form.integers = form.integers && std::abs(value) <= LevelForm::largest_integer;
      if (form.integers)
        divisor = std::gcd(divisor, static_cast<int>(value - integer(green, form.exponent)));
    });
    for (int step = 2; step <= 4; ++step)
      if (divisor != 0 && divisor % step == 0)
        form.step = step;
    return form.integers ? form : LevelForm{};
  }

  static std::int64_t integer(std::uint16_t bits, int exponent) {
    const DyadicHalf value(bits);
    return value.integer == 0 ? 0
                              : static_cast<std::int64_t>(value.integer) *
                                    (std::int64_t{1} << (value.exponent - exponent));
  }

  void append_half(const Tree& tree, std::uint32_t node, unsigned m, const LevelForm& form) {
    std::array<int, 3> values = {};
    for (std::size_t c = 0; c < m_channels; ++c) {
      const std::uint16_t bits = half(tree, node, m, c);
      values[c] = form.integers ? static_cast<int>(integer(bits, form.exponent)) : bits;
    }
    const std::size_t first = m_channels == 3 ? 1 : 0;
    const int base = values[first];
    const auto code = static_cast<std::uint16_t>(base);
    append_planes(0, form.integers ? zigzag(code) : std::rotl(code, 1));
    if (m_channels == 3) {
      append_planes(1, zigzag(static_cast<std::uint16_t>((values[0] - base) / form.step)));
      append_planes(2, zigzag(static_cast<std::uint16_t>((values[2] - base) / form.step)));
    }
  }

  void append_float(const Tree& tree, std::uint32_t node, unsigned m) {
    std::array<std::uint32_t, 3> bits = {};
    std::memcpy(bits.data(), place(tree, node, m), 4 * m_channels);
    const std::uint32_t base = bits[m_channels == 3 ? 1 : 0];
    append_planes(0, std::rotl(base, 1));
    if (m_channels == 3) {
      append_planes(1, zigzag(bits[0] - base));
      append_planes(2, zigzag(bits[2] - base));
    }
  }

  template <class U>
  void append_planes(std::size_t channel, U code) {
    for (std::size_t k = 0; k < sizeof(U); ++k)
      m_streams[3 + channel * sizeof(U) + k].push_back(static_cast<std::byte>(code >> (8 * k)));
  }

  Bytes assemble() const {
    std::vector<std::uint32_t> sizes;
    Bytes block(sizeof(BlockHeader) + sizeof(std::uint32_t) * m_streams.size());
    for (const Bytes& stream : m_streams)
      sizes.push_back(static_cast<std::uint32_t>(append_frame(stream, block)));
    std::memcpy(block.data() + sizeof(BlockHeader), sizes.data(), 4 * sizes.size());
    const BlockHeader header = {static_cast<std::uint32_t>(m_trees.size()),
                                static_cast<std::uint32_t>(block.size()),
                                hash_bytes(std::span(block).subspan(sizeof(BlockHeader)))};
    std::memcpy(block.data(), &header, sizeof header);
    return block;
  }

  std::span<const Tree> m_trees;
  std::size_t m_channels;
  std::size_t m_width;
  std::vector<Bytes> m_streams;
};

} // namespace

EncodedBlock encode_block(std::span<const Tree> trees) {
  assert(!trees.empty());
  return BlockEncoder(trees).encode();
}

} // namespace haarlight::wavelet
