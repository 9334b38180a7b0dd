#pragma once
// Some consecutive trees of a set as one block of a packed file.

#include "file/file_rules.h"

#include <wavelet/tree/tree.h>

#include <optional>
#include <span>
#include <vector>

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

} // namespace haarlight::wavelet
