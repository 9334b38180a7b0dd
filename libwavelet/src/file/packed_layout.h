#pragma once
// The byte layout of packed .haar files, as FORMAT.md specifies it.

#include "file/file_layout.h"

#include <wavelet/tree/tree.h>

namespace haarlight::wavelet {

/// Version 1 is read too: its header checksum does not cover the text frame.
inline constexpr std::uint32_t packed_version = 2;
/// Bounds of a block: bytes its trees take in the mapped form (unless it holds one tree), and
/// trees.
inline constexpr std::uint64_t largest_block_bytes = std::uint64_t{1} << 26U;
inline constexpr std::uint32_t largest_block_trees = 4096;
inline constexpr std::uint64_t largest_packed_text = std::uint64_t{1} << 20U;
/// Nodes of a set whose subtree has no coefficient present. Such nodes cost a packed file next to
/// nothing; 2^18 of them become 6 MB of halves.
inline constexpr std::uint64_t largest_empty_nodes = std::uint64_t{1} << 18U;
inline constexpr const char* empty_nodes_message =
    "more than 2^18 nodes have no coefficient in their subtree";

struct PackedHeader {
  unsigned char magic[8];
  std::uint32_t version;
  std::uint32_t header_bytes;
  std::uint64_t file_bytes;
  std::uint32_t text_frame_bytes;
  std::uint32_t blocks;
  FileHeader mapped;
  std::uint64_t header_checksum;
};
static_assert(sizeof(PackedHeader) == 160);
static_assert(offsetof(PackedHeader, mapped) == 32);

/// Of all fields before it and, from version 2, the text frame.
std::uint64_t packed_header_checksum(const PackedHeader& header,
                                     std::span<const std::byte> text_frame);

/// Begins a block; the sizes of its frames (32 bits each) and the frames follow.
struct BlockHeader {
  std::uint32_t trees;
  std::uint32_t bytes;    ///< of the block, this header included
  std::uint64_t checksum; ///< of all that follows in the block
};
static_assert(sizeof(BlockHeader) == 16);

/// Streams of a block: records, forms, structure, and a plane for every byte of every channel.
constexpr std::size_t stream_count(int channels, CoefficientType type) {
  return 3 + static_cast<std::size_t>(channels) * coefficient_bytes(type);
}

/// What the index knows of a tree; in the record stream byte k of all trees precedes byte k + 1.
struct TreeRecord {
  std::uint32_t node_count;
  float scale;
  float mean[3];
};
static_assert(sizeof(TreeRecord) == 20);

} // namespace haarlight::wavelet
