#include "file_layout.h"

#include <wavelet/error.h>
#include <wavelet/parallel.h>
#include <wavelet/tree_set.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace haarlight::wavelet {
namespace {

/// Reads and checks one file, rule by rule; the rules' letters are FORMAT.md's.
class Checker {
public:
  explicit Checker(const InputFile& file) : m_path(file.path()), m_bytes(file.bytes()) {}

  FileHeader header() const {
    FileHeader h = {};
    require(m_bytes.size() >= 8 && std::memcmp(m_bytes.data(), file_magic, 8) == 0, 0,
            "is no .haar file: it does not begin with the magic 89 48 41 41 52 0d 0a 1a");
    require(m_bytes.size() >= align_up(sizeof h), m_bytes.size(),
            "truncated: a .haar header takes 128 bytes");
    std::memcpy(&h, m_bytes.data(), sizeof h);
    require(h.version == file_version, 8, "format version is not 1");
    require(hash_bytes(m_bytes.first(offsetof(FileHeader, header_checksum))) == h.header_checksum,
            offsetof(FileHeader, header_checksum), "header checksum does not fit the header");
    check_fields(h);
    require(h.file_bytes == m_bytes.size(), 16,
            "truncated or extended: the header says " + std::to_string(h.file_bytes) +
                " bytes, the file has " + std::to_string(m_bytes.size()));
    return h;
  }

  std::vector<IndexEntry> index(const FileHeader& h) const {
    const std::uint64_t count = static_cast<std::uint64_t>(h.columns) * h.rows;
    const auto bytes = section(h.index_offset, count * sizeof(IndexEntry), 64, "index");
    require(hash_bytes(bytes) == h.index_checksum, h.index_offset,
            "index checksum does not fit the index");
    std::vector<IndexEntry> entries(count);
    if (count > 0)
      std::memcpy(entries.data(), bytes.data(), bytes.size());
    for (std::uint64_t i = 0; i < count; ++i)
      check_entry(entries[i], h.index_offset + i * sizeof(IndexEntry));
    return entries;
  }

  std::string text(const FileHeader& h) const {
    const auto bytes = section(h.text_offset, h.text_bytes, 80, "text");
    require(hash_bytes(bytes) == h.text_checksum, h.text_offset,
            "text checksum does not fit the text");
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  TreeView tree(const FileHeader& h, const IndexEntry& entry) const {
    const std::size_t size = h.coefficient_type == 0 ? 2 : 4;
    require(entry.offset % section_alignment == 0, entry.offset,
            "tree offset is no multiple of 16");
    const auto bytes =
        section(entry.offset, tree_size(entry.node_count, h.levels, h.channels, size), entry.offset,
                "tree");
    require(hash_bytes(bytes) == entry.checksum, entry.offset,
            "tree checksum does not fit the tree");
    TreeView view;
    view.levels = static_cast<int>(h.levels);
    view.channels = static_cast<int>(h.channels);
    view.type = static_cast<CoefficientType>(h.coefficient_type);
    view.node_count = entry.node_count;
    view.scale = entry.scale;
    view.mean = {entry.mean[0], entry.mean[1], entry.mean[2]};
    const auto* level_begin = reinterpret_cast<const std::uint32_t*>(bytes.data());
    view.links = level_begin + h.levels + 1;
    view.coefficients = reinterpret_cast<const std::byte*>(view.links + entry.node_count);
    check_links(view, level_begin, entry.offset);
    check_coefficients(view, entry.offset);
    return view;
  }

private:
  void require(bool holds, std::uint64_t offset, const std::string& message) const {
    if (!holds)
      throw_input_error(m_path, message, offset);
  }

  std::span<const std::byte> section(std::uint64_t offset, std::uint64_t size, std::uint64_t field,
                                     const char* name) const {
    require(offset <= m_bytes.size() && size <= m_bytes.size() - offset, field,
            std::string(name) + " reaches beyond the end of the file");
    return m_bytes.subspan(offset, size);
  }

  void check_fields(const FileHeader& h) const {
    require(h.header_bytes == sizeof(FileHeader), 12, "header size is not 120");
    require(h.kind <= 2, 24, "kind is not 0, 1 or 2");
    require(h.domain == domain_octahedral, 28, "domain map is not 1, octahedral equal-area");
    require(h.levels <= largest_levels, 32, "levels exceed 13");
    require(h.channels == 1 || h.channels == 3, 36, "channels are neither 1 nor 3");
    require(h.coefficient_type <= 1, 40, "coefficient type is neither 0 (half) nor 1 (float)");
    require(h.fold <= 2, 44, "fold is not 0, 1 or 2");
    require(h.columns >= 1 && h.columns <= 65536, 48, "columns lie outside 1 … 65536");
    require(h.rows >= 1 && h.rows <= 65536, 52, "rows lie outside 1 … 65536");
    check_rolls(h);
    require((h.flags & ~(flag_cosine | flag_world_frame)) == 0, 60, "reserved flag bits are set");
    require(h.reserved == 0, offsetof(FileHeader, reserved), "reserved field is not 0");
    for (std::size_t i = sizeof h; i < align_up(sizeof h); ++i)
      require(m_bytes[i] == std::byte{0}, i, "padding after the header is not 0");
  }

  /// How many rolls a stored row stands for must come out even.
  void check_rolls(const FileHeader& h) const {
    const std::uint64_t rolls = h.rolls;
    bool fits = rolls == h.rows;
    if (h.kind != static_cast<std::uint32_t>(SetKind::Brdf))
      fits = rolls == 1 && h.fold == 0;
    else if (h.fold == static_cast<std::uint32_t>(Fold::Rotations))
      fits = rolls == 4ULL * h.rows;
    else if (h.fold == static_cast<std::uint32_t>(Fold::Mirrors))
      fits = rolls == 8ULL * h.rows;
    require(fits, 56, "rolls do not fit kind, fold and rows");
  }

  void check_entry(const IndexEntry& e, std::uint64_t offset) const {
    require(e.node_count < (1U << 28U), offset + 16, "node count is 2^28 or more");
    require(std::isfinite(e.scale) && e.scale > 0, offset + 20, "scale is not a positive number");
    for (const float mean : e.mean)
      require(std::isfinite(mean), offset + 24, "mean is not finite");
    require(e.reserved == 0, offset + 36, "reserved field is not 0");
  }

  /// Children follow each other without gaps, level by level, and end where the level table says.
  void check_links(const TreeView& tree, const std::uint32_t* level_begin,
                   std::uint64_t offset) const {
    const auto levels = static_cast<std::size_t>(tree.levels);
    const bool rooted = level_begin[0] == 0 && level_begin[levels] == tree.node_count &&
                        (levels == 0 || level_begin[1] == std::min(tree.node_count, 1U));
    require(rooted, offset, "level table does not run from 0 over the root to the node count");
    std::uint64_t next = std::min(tree.node_count, 1U);
    for (std::size_t l = 0; l < levels; ++l) {
      require(level_begin[l] <= level_begin[l + 1], offset + 4 * l, "level table descends");
      for (std::uint32_t n = level_begin[l]; n < level_begin[l + 1]; ++n) {
        const std::uint64_t at = offset + 4 * (levels + 1 + n);
        require(tree.links[n] >> 4U == next, at, "first child is not the next node in order");
        next += static_cast<std::uint64_t>(std::popcount(tree.links[n] & 15U));
      }
      const std::uint64_t level_end = l + 1 < levels ? level_begin[l + 2] : tree.node_count;
      require(next == level_end, offset + 4 * l, "child masks do not add up to the next level");
    }
  }

  void check_coefficients(const TreeView& tree, std::uint64_t offset) const {
    const std::size_t count = 3 * static_cast<std::size_t>(tree.channels) * tree.node_count;
    const std::uint64_t start =
        offset + 4 * (static_cast<std::uint64_t>(tree.levels) + 1 + tree.node_count);
    const bool half = tree.type == CoefficientType::Half;
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, tree.coefficients + (half ? 2 : 4) * i, half ? 2 : 4);
      const bool special = half ? half_is_special(static_cast<std::uint16_t>(bits))
                                : (bits & 0x7f800000U) == 0x7f800000U;
      require(!special, start + (half ? 2 : 4) * i, "coefficient is not finite");
    }
  }

  std::string m_path;
  std::span<const std::byte> m_bytes;
};

SetInfo info_from(const FileHeader& h, const std::string& text) {
  SetInfo info;
  info.kind = static_cast<SetKind>(h.kind);
  info.size = 1 << h.levels;
  info.columns = static_cast<int>(h.columns);
  info.rows = static_cast<int>(h.rows);
  info.rolls = static_cast<int>(h.rolls);
  info.fold = static_cast<Fold>(h.fold);
  info.cosine = (h.flags & flag_cosine) != 0;
  info.world_frame = (h.flags & flag_world_frame) != 0;
  const Provenance lines = Provenance::parse(text);
  for (const auto& [name, value] : lines.entries()) {
    if (name == "frame")
      info.frame = value;
    else if (name == "units")
      info.units = value;
    else
      info.provenance.set(name, value);
  }
  return info;
}

} // namespace

TreeSet::TreeSet(const std::string& path) : m_file(path) {
  const Checker checker(m_file);
  const FileHeader header = checker.header();
  const std::vector<IndexEntry> index = checker.index(header);
  m_info = info_from(header, checker.text(header));
  m_levels = static_cast<int>(header.levels);
  m_channels = static_cast<int>(header.channels);
  m_type = static_cast<CoefficientType>(header.coefficient_type);
  m_trees.resize(index.size());
  parallel_ranges(index.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      m_trees[i] = checker.tree(header, index[i]);
  });
}

std::uint32_t TreeSet::level_nodes(int column, int row, int level) const {
  const std::uint32_t* level_begin = tree(column, row).links - (m_levels + 1);
  return level_begin[level + 1] - level_begin[level];
}

std::uint64_t TreeSet::tree_bytes(int column, int row) const {
  return tree_size(tree(column, row).node_count, static_cast<std::uint64_t>(m_levels),
                   static_cast<std::uint64_t>(m_channels), coefficient_bytes(m_type));
}

bool begins_as_tree_set(const InputFile& file) {
  // What comes after the name tells damage by text-mode transfers.
  return file.bytes().size() >= 8 && std::memcmp(file.bytes().data(), file_magic, 5) == 0;
}

} // namespace haarlight::wavelet
