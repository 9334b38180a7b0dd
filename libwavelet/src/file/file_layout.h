#pragma once
// The byte layout of .haar files, as FORMAT.md specifies it.

#include <wavelet/tree/map_set.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

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

/// By the name in the magic; what comes after it tells damage by text-mode transfers.
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

} // namespace haarlight::wavelet
