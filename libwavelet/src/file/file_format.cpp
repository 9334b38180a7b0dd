#include "file/file_format.h"

#include <wavelet/base/error.h>
#include <wavelet/file/input_file.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

namespace haarlight::wavelet {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

template <class T>
void append(std::vector<std::byte>& bytes, const T* values, std::size_t count) {
  const auto* p = reinterpret_cast<const std::byte*>(values);
  bytes.insert(bytes.end(), p, p + count * sizeof(T));
}

FileHeader describe(const SetInfo& info, int channels, CoefficientType type) {
  FileHeader header = {};
  std::memcpy(header.magic, file_magic, sizeof file_magic);
  header.version = file_version;
  header.header_bytes = sizeof(FileHeader);
  header.kind = static_cast<std::uint32_t>(info.kind);
  header.domain = domain_octahedral;
  header.levels = static_cast<std::uint32_t>(std::countr_zero(static_cast<unsigned>(info.size)));
  header.channels = static_cast<std::uint32_t>(channels);
  header.coefficient_type = static_cast<std::uint32_t>(type);
  header.fold = static_cast<std::uint32_t>(info.fold);
  header.columns = static_cast<std::uint32_t>(info.columns);
  header.rows = static_cast<std::uint32_t>(info.rows);
  header.rolls = static_cast<std::uint32_t>(info.rolls);
  header.flags = (info.cosine ? flag_cosine : 0U) | (info.world_frame ? flag_world_frame : 0U);
  return header;
}

std::string text_section(const SetInfo& info) {
  return "frame=" + info.frame + "\nunits=" + info.units + "\n" + info.provenance.text();
}

} // namespace

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

SetLayout::SetLayout(const SetInfo& info, int channels, CoefficientType type)
    : m_header(describe(info, channels, type)), m_text(text_section(info)),
      m_position(align_up(sizeof(FileHeader))) {}

std::vector<std::byte> SetLayout::add(const Tree& tree) {
  const auto type = static_cast<CoefficientType>(m_header.coefficient_type);
  assert(tree.levels == static_cast<int>(m_header.levels) && tree.type == type &&
         tree.channels == static_cast<int>(m_header.channels));
  const std::size_t nodes = tree.links.size();
  std::vector<std::byte> bytes;
  bytes.reserve(tree_size(nodes, m_header.levels, m_header.channels, coefficient_bytes(type)));
  append(bytes, tree.level_begin.data(), tree.level_begin.size());
  append(bytes, tree.links.data(), nodes);
  append(bytes, tree.coefficients.data(), 3 * m_header.channels * nodes * coefficient_bytes(type));
  bytes.resize(align_up(bytes.size() + tree_padding));
  m_index.push_back({m_position,
                     hash_bytes(bytes),
                     static_cast<std::uint32_t>(nodes),
                     tree.scale,
                     {tree.mean[0], tree.mean[1], tree.mean[2]},
                     0});
  m_position += bytes.size();
  return bytes;
}

void SetLayout::finish() {
  assert(m_index.size() == static_cast<std::size_t>(m_header.columns) * m_header.rows);
  const auto index_bytes = std::as_bytes(std::span(m_index));
  m_header.index_offset = m_position;
  m_header.index_checksum = hash_bytes(index_bytes);
  m_header.text_offset = m_position + index_bytes.size();
  m_header.text_bytes = m_text.size();
  m_header.text_checksum = hash_bytes(std::as_bytes(std::span(m_text)));
  m_header.file_bytes = m_header.text_offset + m_text.size();
  m_header.header_checksum = hash_bytes(
      std::as_bytes(std::span(&m_header, 1)).first(offsetof(FileHeader, header_checksum)));
}

void FileRules::refuse(std::uint64_t offset, const std::string& message) const {
  throw_input_error(m_path, message, offset);
}

void FileRules::check_header(const FileHeader& h, std::uint64_t offset) const {
  require(std::memcmp(h.magic, file_magic, sizeof h.magic) == 0, offset,
          "magic is not 89 48 41 41 52 0d 0a 1a");
  require(h.version == file_version, offset + 8, "format version is not 1");
  const auto bytes = std::as_bytes(std::span(&h, 1));
  require(hash_bytes(bytes.first(offsetof(FileHeader, header_checksum))) == h.header_checksum,
          offset + offsetof(FileHeader, header_checksum),
          "header checksum does not fit the header");
  require(h.header_bytes == sizeof(FileHeader), offset + 12, "header size is not 120");
  require(h.kind <= 3, offset + 24, "kind is not 0, 1, 2 or 3");
  require(h.domain == domain_octahedral, offset + 28, "domain map is not 1, octahedral equal-area");
  require(h.levels <= largest_levels, offset + 32, "levels exceed 13");
  require(h.channels == 1 || h.channels == 3, offset + 36, "channels are neither 1 nor 3");
  require(h.coefficient_type <= 1, offset + 40,
          "coefficient type is neither 0 (half) nor 1 (float)");
  require(h.fold <= 2, offset + 44, "fold is not 0, 1 or 2");
  require(h.columns >= 1 && h.columns <= 65536, offset + 48, "columns lie outside 1 … 65536");
  require(h.rows >= 1 && h.rows <= 65536, offset + 52, "rows lie outside 1 … 65536");
  require(static_cast<std::uint64_t>(h.columns) * h.rows < (std::uint64_t{1} << 31U), offset + 48,
          "columns times rows are 2^31 or more");
  check_rolls(h, offset);
  require((h.flags & ~(flag_cosine | flag_world_frame)) == 0, offset + 60,
          "reserved flag bits are set");
  require(h.reserved == 0, offset + offsetof(FileHeader, reserved), "reserved field is not 0");
}

/// How many rolls a stored row stands for must come out even.
void FileRules::check_rolls(const FileHeader& h, std::uint64_t offset) const {
  const std::uint64_t rolls = h.rolls;
  bool fits = rolls == h.rows;
  if (h.kind != static_cast<std::uint32_t>(SetKind::Brdf))
    fits = rolls == 1 && h.fold == 0;
  else if (h.fold == static_cast<std::uint32_t>(Fold::Rotations))
    fits = rolls == 4ULL * h.rows;
  else if (h.fold == static_cast<std::uint32_t>(Fold::Mirrors))
    fits = rolls == 8ULL * h.rows;
  require(fits, offset + 56, "rolls do not fit kind, fold and rows");
}

void FileRules::check_entry(const IndexEntry& e, std::uint64_t offset) const {
  require(e.node_count < (1U << 28U), offset + 16, "node count is 2^28 or more");
  require(std::isfinite(e.scale) && e.scale > 0, offset + 20, "scale is not a positive number");
  for (const float mean : e.mean)
    require(std::isfinite(mean), offset + 24, "mean is not finite");
  require(e.reserved == 0, offset + 36, "reserved field is not 0");
}

void FileRules::check_links(const TreeView& tree, std::uint64_t offset) const {
  const auto levels = static_cast<std::size_t>(tree.levels);
  const std::uint32_t* level_begin = tree.links - (levels + 1);
  const bool rooted = level_begin[0] == 0 && level_begin[levels] == tree.node_count &&
                      (levels == 0 || level_begin[1] == std::min(tree.node_count, 1U));
  require(rooted, offset, "level table does not run from 0 over the root to the node count");
  std::uint64_t next = std::min(tree.node_count, 1U);
  for (std::size_t l = 0; l < levels; ++l) {
    require(level_begin[l] <= level_begin[l + 1] && level_begin[l + 1] <= tree.node_count,
            offset + 4 * l, "level table descends");
    for (std::uint32_t n = level_begin[l]; n < level_begin[l + 1]; ++n) {
      const std::uint64_t at = offset + 4 * (levels + 1 + n);
      require(tree.links[n] >> 4U == next, at, "first child is not the next node in order");
      next += detail::bits_of_nibble(tree.links[n] & 15U);
    }
    const std::uint64_t level_end = l + 1 < levels ? level_begin[l + 2] : tree.node_count;
    require(next == level_end, offset + 4 * l, "child masks do not add up to the next level");
  }
}

void FileRules::check_coefficients(const TreeView& tree, std::uint64_t offset) const {
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

} // namespace haarlight::wavelet
