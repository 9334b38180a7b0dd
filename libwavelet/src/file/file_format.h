#pragma once
// The byte layout of .haar files in both forms and the rules of FORMAT.md that header, index and
// trees must keep.

#include <wavelet/tree/map_set.h>
#include <wavelet/tree/tree.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace haarlight::wavelet {

inline constexpr unsigned char file_magic[8] = {0x89, 'H', 'A', 'A', 'R', '\r', '\n', 0x1a};
inline constexpr unsigned char packed_magic[8] = {0x89, 'H', 'A', 'A', 'P', '\r', '\n', 0x1a};
inline constexpr std::uint32_t file_version = 1;
inline constexpr std::uint32_t domain_octahedral = 1;
inline constexpr std::uint32_t flag_cosine = 1;
inline constexpr std::uint32_t flag_world_frame = 2;
inline constexpr std::uint32_t largest_levels = 13;
inline constexpr std::uint64_t section_alignment = 16;
/// Zero bytes after the last coefficient, so that eight bytes may be loaded from any of them.
inline constexpr std::uint64_t tree_padding = 8;

struct FileHeader {
  unsigned char magic[8];
  std::uint32_t version;
  std::uint32_t header_bytes;
  std::uint64_t file_bytes;
  std::uint32_t kind;
  std::uint32_t domain;
  std::uint32_t levels;
  std::uint32_t channels;
  std::uint32_t coefficient_type;
  std::uint32_t fold;
  std::uint32_t columns;
  std::uint32_t rows;
  std::uint32_t rolls;
  std::uint32_t flags;
  std::uint64_t index_offset;
  std::uint64_t index_checksum;
  std::uint64_t text_offset;
  std::uint64_t text_bytes;
  std::uint64_t text_checksum;
  std::uint64_t reserved;
  std::uint64_t header_checksum;
};
static_assert(sizeof(FileHeader) == 120);
static_assert(offsetof(FileHeader, index_offset) == 64);
static_assert(offsetof(FileHeader, header_checksum) == 112);

struct IndexEntry {
  std::uint64_t offset;
  std::uint64_t checksum;
  std::uint32_t node_count;
  float scale;
  float mean[3];
  std::uint32_t reserved;
};
static_assert(sizeof(IndexEntry) == 40);

inline std::uint64_t align_up(std::uint64_t value) {
  return (value + section_alignment - 1) / section_alignment * section_alignment;
}

/// Bytes of a tree: level table, links, coefficients, padding.
inline std::uint64_t tree_size(std::uint64_t nodes, std::uint64_t levels, std::uint64_t channels,
                               std::uint64_t coefficient_size) {
  return align_up(4 * (levels + 1) + 4 * nodes + 3 * channels * coefficient_size * nodes +
                  tree_padding);
}

/// Detected by the name in the magic; the bytes after it reveal damage by text-mode transfers.
inline bool begins_with(std::span<const std::byte> bytes, const unsigned char (&magic)[8]) {
  return bytes.size() >= sizeof magic && std::memcmp(bytes.data(), magic, 5) == 0;
}
inline bool begins_mapped(std::span<const std::byte> bytes) {
  return begins_with(bytes, file_magic);
}
inline bool begins_packed(std::span<const std::byte> bytes) {
  return begins_with(bytes, packed_magic);
}

/// What header and text say of a set.
SetInfo info_from(const FileHeader& header, const std::string& text);

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

/// Refuses a file at the first rule that does not hold.
class FileRules {
public:
  /// @param path of the file, as errors shall name it
  explicit FileRules(std::string path) : m_path(std::move(path)) {}

  /// @throws Error(Input) with the message unless the rule holds
  void require(bool holds, std::uint64_t offset, const char* message) const {
    if (!holds)
      refuse(offset, message);
  }
  [[noreturn]] void refuse(std::uint64_t offset, const std::string& message) const;

  /// Everything but the offsets and sizes of sections. @param offset of the header in the file
  void check_header(const FileHeader& header, std::uint64_t offset) const;
  void check_entry(const IndexEntry& entry, std::uint64_t offset) const;
  /// Children follow each other without gaps, level by level, and end where the level table says.
  /// @param offset of the tree in the file, whose level table lies before the view's links
  void check_links(const TreeView& tree, std::uint64_t offset) const;
  void check_coefficients(const TreeView& tree, std::uint64_t offset) const;

private:
  void check_rolls(const FileHeader& header, std::uint64_t offset) const;

  std::string m_path;
};

/// Header, index and text of a mapped file, updated while its trees are made. Both forms need them:
/// the packed one carries the header of the mapped one.
class SetLayout {
public:
  SetLayout(const SetInfo& info, int channels, CoefficientType type);

  /// Notes the next tree. @return its bytes in the mapped form, padding included
  std::vector<std::byte> add(const Tree& tree);

  /// Fills in what depends on the trees, all of which must have been added.
  void finish();

  const FileHeader& header() const { return m_header; }
  const std::string& text() const { return m_text; }
  const std::vector<IndexEntry>& index() const { return m_index; }

private:
  FileHeader m_header;
  std::string m_text;
  std::vector<IndexEntry> m_index;
  std::uint64_t m_position;
};

} // namespace haarlight::wavelet
