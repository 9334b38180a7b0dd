#pragma once
// Some consecutive trees of a set as one block of a packed file, and the numbers that its
// coefficients are stored as: colours as differences from green, small numbers for small values of
// either sign. Lossless.

#include "file/file_format.h"

#include <wavelet/base/half.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace haarlight::wavelet {

struct EncodedBlock {
  std::vector<std::byte> bytes;
  std::uint64_t empty_nodes = 0; ///< see count_empty_nodes()
};

/// @param trees of one set, within the bounds of <packed_layout.h>
EncodedBlock encode_block(std::span<const Tree> trees);

/// Nodes whose subtree has no coefficient present.
/// @param structure of a block, bits 7 clear; is used for marks and comes out unchanged
/// @return nothing if the child masks do not fit the number of nodes
std::optional<std::uint64_t> count_empty_nodes(std::span<std::byte> structure);

/// The sizes that a block states; see scan_block().
struct BlockSizes {
  std::uint64_t nodes = 0;
  std::uint64_t values = 0;       ///< coefficients present
  std::uint64_t mapped_bytes = 0; ///< of its trees in the mapped form
};

/// Reads the records and the sizes of the frames and checks that they agree. Allocates a few KiB;
/// decodes nothing else.
/// @param block  a whole block
/// @param set    a checked header: levels, channels and type of the trees
/// @param rules  names the file in errors
/// @param offset of the block in the file
/// @throws Error(Input) at the first broken rule
BlockSizes scan_block(std::span<const std::byte> block, const FileHeader& set,
                      const FileRules& rules, std::uint64_t offset);

struct DecodedBlock {
  std::vector<Tree> trees;
  std::uint64_t empty_nodes = 0; ///< see count_empty_nodes()
};

/// Parameters as for scan_block().
/// @throws Error(Input) at the first broken rule; nothing is allocated before its size is checked
DecodedBlock decode_block(std::span<const std::byte> block, const FileHeader& set,
                          const FileRules& rules, std::uint64_t offset);

/// Unsigned numbers of 16 or 32 bits from signed ones: 0, −1, 1, −2, 2 … become 0, 1, 2, 3, 4 …
template <class U>
constexpr U zigzag(U value) {
  constexpr int top = 8 * sizeof(U) - 1;
  return static_cast<U>(static_cast<U>(value << 1U) ^ static_cast<U>(-(value >> top)));
}

template <class U>
constexpr U unzigzag(U code) {
  return static_cast<U>(static_cast<U>(code >> 1U) ^ static_cast<U>(-(code & 1U)));
}

/// How the halves of one level of a tree are stored: as bit patterns, or, if all are integer
/// multiples of a power of two, as those integers.
struct LevelForm {
  static constexpr int exponent_bias = 25;
  static constexpr int largest_integer = 16383;

  bool integers = false;
  int exponent = 0; ///< of the power of two, −24 … 15
  int step = 1;     ///< red and blue differ from green by multiples of it, 1 … 4

  std::uint8_t byte() const {
    return static_cast<std::uint8_t>(integers ? exponent + exponent_bias + 64 * (step - 1) : 0);
  }
  static std::optional<LevelForm> parse(std::uint8_t byte) {
    if (byte == 0)
      return LevelForm{};
    const int exponent = (byte & 63) - exponent_bias;
    if (exponent < -24 || exponent > 15)
      return std::nullopt;
    return LevelForm{true, exponent, byte / 64 + 1};
  }
};

/// A half as integer · 2^exponent with an odd integer, or 0.
struct DyadicHalf {
  int integer;
  int exponent;

  explicit DyadicHalf(std::uint16_t half) {
    const int field = (half >> 10) & 31;
    integer = (half & 1023) + (field > 0 ? 1024 : 0);
    exponent = std::max(field, 1) - 25;
    const int zeros = integer != 0 ? std::countr_zero(static_cast<unsigned>(integer)) : 0;
    integer >>= zeros;
    exponent += zeros;
    if ((half & 0x8000) != 0)
      integer = -integer;
  }
};

} // namespace haarlight::wavelet
